use sandtable_dem::hints::DemHints;
use sandtable_dem::read::read;
#[test]
fn oracle() {
    let dir = std::env::var("ORACLE").unwrap_or("/tmp/h/formats-venv/o".into());
    let mut names: Vec<_> = std::fs::read_dir(&dir).unwrap().map(|e| e.unwrap().path()).collect();
    names.sort();
    let (mut n, mut bad) = (0, 0);
    for p in names {
        let name = p.to_string_lossy().into_owned();
        if name.ends_with(".f64") || name.ends_with(".xml") {
            continue;
        }
        let Ok(e) = std::fs::read(format!("{name}.f64")) else { continue };
        n += 1;
        let want: Vec<f64> = e.chunks(8).map(|c| f64::from_le_bytes(c.try_into().unwrap())).collect();
        let bytes = std::fs::read(&p).unwrap();
        let tol: f64 = if name.ends_with(".gpkg") { 1e-4 } else { 0.0 };
        match read(&name, &bytes, &DemHints::default()) {
            Err(e) => {
                bad += 1;
                println!("BAD {name}: {e}")
            }
            Ok(r) => {
                let got: Vec<f64> = r.samples.iter().collect();
                let d = got
                    .iter()
                    .zip(&want)
                    .filter(|(a, b)| {
                        !(a.is_nan() && b.is_nan())
                            && !(**a == 0.0 && b.is_nan() && std::env::var("X").is_ok())
                            && a != b
                    })
                    .count();
                if got.len() != want.len() || d > 0 {
                    bad += 1;
                    println!(
                        "BAD {name}: {} differ of {}, {} wanted; first {:?}",
                        d,
                        got.len(),
                        want.len(),
                        got.iter()
                            .zip(&want)
                            .enumerate()
                            .find(|(_, (a, b))| !(a.is_nan() && b.is_nan()) && a != b)
                    );
                } else if std::env::var("V").is_ok() {
                    println!(
                        "ok {name} {:?} {:?} {:?} nod {:?}",
                        r.geotransform(),
                        r.crs.as_ref().map(|c| (c.epsg(), c.name().to_owned())),
                        r.data_type,
                        r.nodata
                    );
                }
            }
        }
    }
    println!("{n} files, {bad} bad");
    assert_eq!(bad, 0);
}
