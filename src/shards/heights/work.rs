//! One shard of heights.

use std::io::{Read, Seek, SeekFrom};

use glam::DVec2;

use crate::error::{PlanError, PlanFault, ShardError};
use crate::heights::arguments::HeightsArguments;
use crate::heights::plan::{MOST_POINTS, POINT_BYTES};
use crate::plan::ShardPlan;
use crate::planned_dataset::QueriedDataset;
use crate::shard::{PointRange, Shard};
use sandtable_base::limits::PLAN_POINTS;
use sandtable_files::disk::{self, ReadFileError, SystemError};
use sandtable_files::fingerprint::content_hash;
use sandtable_raster::answer::Answer;

/// The extension of a shard's results.
pub const EXTENSION: &str = "heights";
/// The bytes of an answer: the height and the status.
pub const ANSWER_BYTES: usize = 9;

/// The answers at the points of a shard, as bytes.
///
/// # Errors
/// The shard or its points are not those of the plan, or the elevation cannot be read.
pub fn result(
    plan: &ShardPlan,
    arguments: &HeightsArguments,
    queried: &QueriedDataset,
    shard: &Shard,
) -> Result<Vec<u8>, ShardError> {
    let at = points(plan, shard)?;
    Ok(arguments.answers(queried, &at)?.into_iter().flat_map(answer_bytes).collect())
}

/// The positions of a shard.
fn points(plan: &ShardPlan, shard: &Shard) -> Result<Vec<DVec2>, ShardError> {
    let is_sound = |range: &&PointRange| range.count <= MOST_POINTS && range.first <= PLAN_POINTS.get();
    let range = shard.points.as_ref().filter(is_sound);
    let range = range.ok_or_else(|| plan.wrong_shard(shard.id, "it has no points, or too many"))?;
    let path = plan.folder.join("points.bin");
    let failed = |error| ReadFileError::new(&path, SystemError::from(error));
    let mut file = disk::open(&path)?;
    file.seek(SeekFrom::Start(range.first * POINT_BYTES)).map_err(failed)?;
    let mut bytes = Vec::new();
    file.take(range.count * POINT_BYTES).read_to_end(&mut bytes).map_err(failed)?;
    if content_hash(&bytes) != range.sha256 {
        let what = "the points of the shard are not those that were planned".to_owned();
        return Err(PlanError::new(&path, PlanFault::Stale(what)).into());
    }
    let (numbers, _) = bytes.as_chunks::<8>();
    let numbers: Vec<f64> = numbers.iter().map(|&number| f64::from_le_bytes(number)).collect();
    Ok(numbers.chunks_exact(2).map(DVec2::from_slice).collect())
}

fn answer_bytes(answer: Answer) -> [u8; ANSWER_BYTES] {
    let (height, status) = answer.parts();
    let mut bytes = [0; ANSWER_BYTES];
    bytes[..8].copy_from_slice(&height.to_le_bytes());
    bytes[8] = status as u8;
    bytes
}

/// The answer in some bytes; `None` where they hold none.
pub fn answer_of([height @ .., status]: [u8; ANSWER_BYTES]) -> Option<Answer> {
    let height = f64::from_le_bytes(height);
    match status {
        0 if !height.is_nan() => Some(Answer::Height(height)),
        1 => Some(Answer::NoData),
        2 => Some(Answer::Outside),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn answers_come_back_from_their_bytes() {
        for answer in [Answer::Height(-12.25), Answer::Height(1e-300), Answer::NoData, Answer::Outside] {
            assert_eq!(answer_of(answer_bytes(answer)), Some(answer));
        }
        assert_eq!(answer_of([7; ANSWER_BYTES]), None);
    }
}
