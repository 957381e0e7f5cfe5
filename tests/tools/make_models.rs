//! Writes the project's own models into `assets/models/`: `cargo run --example make-models`.

#[path = "models/mod.rs"]
mod models;

fn main() -> std::io::Result<()> {
    let folder = std::path::Path::new(concat!(env!("SANDTABLE_ROOT"), "assets/models"));
    std::fs::create_dir_all(folder)?;
    for (name, bytes) in models::files() {
        std::fs::write(folder.join(name), &bytes)?;
        println!("{name}: {} bytes", bytes.len());
    }
    Ok(())
}
