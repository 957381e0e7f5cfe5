//! Rounds: A B A B …, so that another program's load falls on all contenders alike.
//!
//! A ratio is taken within each round, where both times lie side by side, and the median over the rounds counts.

use std::time::Instant;

/// Rounds where a section has no reason for another number; odd, so that a median is a value that was measured.
pub const ROUNDS: usize = 7;

/// Prints the sections that the arguments name, or all of them.
pub fn sections(sections: &[(&'static str, fn())]) {
    // cargo hands on flags of its own, such as --bench
    let wanted: Vec<String> = std::env::args().skip(1).filter(|name| !name.starts_with('-')).collect();
    let names: Vec<&str> = sections.iter().map(|&(name, _)| name).collect();
    if let Some(unknown) = wanted.iter().find(|name| !names.contains(&name.as_str())) {
        eprintln!("there is no section '{unknown}'; there are {}", names.join(", "));
        std::process::exit(2);
    }
    println!("{}", machine());
    if cfg!(debug_assertions) {
        println!("This is a build for debugging: its times say nothing about a release.");
    }
    for (name, print) in sections {
        if wanted.is_empty() || wanted.iter().any(|wanted| wanted == name) {
            println!("\n== {name} (load {})\n", load());
            print();
        }
    }
}

/// Runs all contenders in turn, `rounds` times: for each the values that it returned, in the order of the rounds.
pub fn interleaved(rounds: usize, contenders: &mut [&mut dyn FnMut() -> f64]) -> Vec<Vec<f64>> {
    let mut values = vec![Vec::with_capacity(rounds); contenders.len()];
    for _ in 0..rounds {
        for (contender, values) in contenders.iter_mut().zip(&mut values) {
            values.push(contender());
        }
    }
    values
}

/// How long `work` takes, milliseconds.
pub fn time_ms<T>(work: impl FnOnce() -> T) -> f64 {
    let start = Instant::now();
    std::hint::black_box(work());
    start.elapsed().as_secs_f64() * 1e3
}

/// The value that a share of the others lies below: 0.5 for the median.
pub fn quantile(values: &[f64], share: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let at = (sorted.len() as f64 * share).ceil() as usize;
    sorted.get(at.saturating_sub(1)).copied().unwrap_or(f64::NAN)
}

/// The median.
pub fn median(values: &[f64]) -> f64 {
    quantile(values, 0.5)
}

/// How many times as long `slow` takes as `fast`: the median over the rounds of both times' ratio.
pub fn ratio(slow: &[f64], fast: &[f64]) -> f64 {
    let ratios: Vec<f64> = slow.iter().zip(fast).map(|(slow, fast)| slow / fast).collect();
    median(&ratios)
}

/// The parameter between `low` and `high` at which the falling `count` meets `target`, by halving on a logarithmic
/// scale.
pub fn bisected(target: f64, (mut low, mut high): (f32, f32), mut count: impl FnMut(f32) -> f64) -> f32 {
    for _ in 0..24 {
        let middle = (low * high).sqrt();
        if count(middle) > target { low = middle } else { high = middle }
    }
    (low * high).sqrt()
}

/// Cores and processor, in a line.
pub fn machine() -> String {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let about = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = about.lines().find_map(|line| line.strip_prefix("model name")).unwrap_or("unknown processor");
    format!("{cores} cores, {}", model.trim_start_matches([' ', '\t', ':']))
}

/// The load over the last minute, as the system tells it.
pub fn load() -> String {
    let text = std::fs::read_to_string("/proc/loadavg").unwrap_or_default();
    text.split(' ').next().filter(|load| !load.is_empty()).unwrap_or("unknown").to_owned()
}
