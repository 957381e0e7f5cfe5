//! Heights brought to another vertical datum.

use glam::DVec2;

use sandtable_base::limits::GEOID_NODES;
use sandtable_geom::crs::{Crs, CrsError};
use sandtable_geom::geoid::{Geoid, GeoidWorkError};
use sandtable_raster::answer::Answer;
use sandtable_raster::height_datum::HeightDatum;

/// Why heights cannot be brought to another vertical datum.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[allow(missing_docs, reason = "the messages explain the variants")]
pub enum HeightsAboveError {
    #[error(
        "nothing states what its heights are counted from: state --vertical-datum, such as egm96, or vertical_datum in a \
         scene's [terrain]"
    )]
    NotStated,
    #[error(
        "its heights are counted from {0}, whose distance from the ellipsoid is not known here: only that of egm96 is"
    )]
    Unknown(String),
    #[error("the geoid needs longitude and latitude")]
    NoPlace(#[source] CrsError),
    #[error("{0}, or {GEOID_NODES:#}")]
    Work(GeoidWorkError),
}

/// Brings heights at positions in coordinates of `crs` from the datum called `from` to `to`.
///
/// # Errors
/// See [`HeightsAboveError`].
pub fn bring_heights(
    answers: &mut [Answer],
    (from, to): (Option<&str>, HeightDatum),
    (crs, at): (&Crs, &[DVec2]),
    geoid: &Geoid,
) -> Result<(), HeightsAboveError> {
    let stated = from.ok_or(HeightsAboveError::NotStated)?;
    let from = HeightDatum::from_name(stated).ok_or_else(|| HeightsAboveError::Unknown(stated.to_owned()))?;
    let factor = from.undulations_to(to);
    if factor == 0.0 {
        return Ok(());
    }
    let wgs84 = Crs::wgs84();
    let found: Vec<usize> = (0..at.len()).filter(|&index| answers[index].height_m().is_some()).collect();
    let places = found.iter().map(|&index| crs.transform(&wgs84, at[index]));
    let places = places.collect::<Result<Vec<DVec2>, _>>().map_err(HeightsAboveError::NoPlace)?;
    let undulations = geoid.undulations(&places, GEOID_NODES.count()).map_err(HeightsAboveError::Work)?;
    for (index, undulation_m) in found.into_iter().zip(undulations) {
        if let Answer::Height(height_m) = &mut answers[index] {
            *height_m += factor * undulation_m;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn above(from: Option<&str>, to: HeightDatum, crs: &Crs, at: DVec2) -> Result<Answer, HeightsAboveError> {
        let mut answers = [Answer::Height(100.0), Answer::NoData];
        bring_heights(&mut answers, (from, to), (crs, &[at, at]), &Geoid::default())?;
        assert_eq!(answers[1], Answer::NoData);
        Ok(answers[0])
    }

    #[test]
    fn heights_go_to_the_ellipsoid_and_back_in_any_system() {
        let (wgs84, utm) = (Crs::wgs84(), Crs::parse("EPSG:32632").expect("a system"));
        let munich = DVec2::new(11.58, 48.14);
        let east = wgs84.transform(&utm, munich).expect("in the zone");
        for (crs, at) in [(&wgs84, munich), (&utm, east)] {
            let up = above(Some("EGM96 geoid"), HeightDatum::Ellipsoid, crs, at).expect("known");
            assert!(matches!(up, Answer::Height(height) if (height - 145.467).abs() < 0.005), "{up:?}");
            let down = above(Some("WGS 84 ellipsoid"), HeightDatum::Egm96, crs, at).expect("known");
            assert!(matches!(down, Answer::Height(height) if (height - 54.533).abs() < 0.005), "{down:?}");
        }
        let same = above(Some("egm96"), HeightDatum::Egm96, &Crs::local(), DVec2::ZERO);
        assert_eq!(same, Ok(Answer::Height(100.0)));
    }

    #[test]
    fn what_is_not_known_is_refused() {
        let at =
            |from, crs: &Crs| above(from, HeightDatum::Ellipsoid, crs, DVec2::ZERO).expect_err("refused");
        assert_eq!(at(None, &Crs::wgs84()), HeightsAboveError::NotStated);
        assert_eq!(at(Some("NAVD88"), &Crs::wgs84()), HeightsAboveError::Unknown("NAVD88".into()));
        assert!(matches!(at(Some("EGM96 geoid"), &Crs::local()), HeightsAboveError::NoPlace(_)));
    }
}
