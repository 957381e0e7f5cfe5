//! The renderer of an atlas, which its plan states.
//!
//! `gpu_backend` is in the names of the tests that need an adapter.

use std::fs;

use image::RgbImage;

use crate::cli::run_in;
use crate::cli::shards_atlas::{picture, planned, scene};
use crate::common::scratch::Scratch;
use crate::common::skip::skipped;

/// The scale of the sheets.
const SCALE: [&str; 4] = ["--scale", "120000", "--dpi", "60"];

fn plan_file(scratch: &Scratch) -> String {
    fs::read_to_string(scratch.at("plan/plan.json")).expect("written")
}

/// The sheets of an atlas that the processor draws.
fn sheets_of_the_processor() -> Vec<RgbImage> {
    let scratch = scene("margin");
    let count = planned(&scratch, &SCALE).len();
    run_in(scratch.folder(), &["work", "plan", "--shards", &format!("0..{count}")]).ok();
    (0..count).map(|id| picture(&scratch, id)).collect()
}

/// Compares sheets with the processor's.
fn assert_near(sheets: &[RgbImage]) {
    let of_the_processor = sheets_of_the_processor();
    assert_eq!(sheets.len(), of_the_processor.len());
    for (sheet, own) in sheets.iter().zip(&of_the_processor) {
        assert_eq!(sheet.dimensions(), own.dimensions());
        let channels = sheet.iter().zip(own.iter());
        let sum: u64 = channels.map(|(&a, &b)| u64::from(a.abs_diff(b))).sum();
        let mean = sum as f64 / sheet.len() as f64;
        assert!(mean <= 0.75, "the sheets differ by {mean} steps");
    }
}

#[test]
fn a_plan_states_its_renderer_where_that_is_not_the_processor() {
    let scratch = scene("none");
    planned(&scratch, &SCALE);
    let own = plan_file(&scratch);
    planned(&scratch, &[&SCALE[..], &["--backend", "cpu"]].concat());
    assert_eq!(plan_file(&scratch), own);
    assert!(!own.contains("backend"), "{own}");
    planned(&scratch, &[&SCALE[..], &["--backend", "gpu"]].concat());
    let on_card = plan_file(&scratch);
    assert_eq!(on_card.replace(",\n    \"backend\": \"gpu\"", ""), own);
    scratch.write("plan/plan.json", on_card.replace("\"gpu\"", "\"abacus\""));
    let message = run_in(scratch.folder(), &["work", "plan", "--shard", "0"]).failed(1);
    assert!(message.contains("found 'abacus', the words are cpu, gpu"), "{message}");
}

#[test]
fn the_gpu_backend_draws_sheets_or_the_worker_says_what_it_lacks() {
    let scratch = scene("margin");
    let count = planned(&scratch, &[&SCALE[..], &["--backend", "gpu"]].concat()).len();
    let ran = run_in(scratch.folder(), &["work", "plan", "--shards", &format!("0..{count}")]);
    if cfg!(feature = "gpu") && ran.code == 0 {
        assert_near(&(0..count).map(|id| picture(&scratch, id)).collect::<Vec<_>>());
        run_in(scratch.folder(), &["gather", "plan"]).ok();
        return;
    }
    let refused = ran.failed(1);
    if cfg!(feature = "gpu") {
        skipped(&format!("no GPU adapter: {refused}"));
        assert!(std::env::var_os("SANDTABLE_REQUIRE_GPU").is_none(), "{refused}");
    } else {
        assert!(refused.contains("cargo run --features gpu -- "), "{refused}");
    }
    assert!(refused.contains("plan again with cpu") && refused.contains("--backend cpu"), "{refused}");
    assert_eq!(refused.matches("plan.json").count(), 1, "it is said once: {refused}");
    assert!(!scratch.at("plan/shards/000000.png").exists());
}

#[cfg(feature = "gpu")]
mod device {
    use std::error::Error;
    use std::sync::{Arc, Mutex};

    use sandtable_draw::list::DrawList;
    use sandtable_gpu::adapter::{Gpu, GpuApi};
    use sandtable_gpu::picture_renderer::PictureRenderer;
    use sandtable_render::picture::Rendering;
    use sandtable_shards::plan::ShardPlan;
    use sandtable_shards::work::ShardWorker;
    use sandtable_view::camera::Camera;

    use super::*;

    static RENDERER: Mutex<Option<PictureRenderer>> = Mutex::new(None);

    type Drawn = Result<Rendering, Box<dyn Error + Send + Sync>>;

    fn draw(list: &DrawList, camera: &Camera, progress: &dyn Fn(&'static str)) -> Drawn {
        let mut renderer = RENDERER.lock().expect("whole");
        Ok(renderer.as_mut().expect("opened").render(list, camera, progress)?)
    }

    /// The pipelines that are made, and the ground maps that were sent.
    fn counts() -> [usize; 2] {
        let renderer = RENDERER.lock().expect("whole");
        renderer.as_ref().map_or([0; 2], |renderer| [renderer.pipelines(), renderer.grounds_sent()])
    }

    #[test]
    fn the_gpu_backend_keeps_pipelines_and_ground_from_sheet_to_sheet() {
        let gpu = match Gpu::open(&[GpuApi::Vulkan]) {
            Ok(gpu) => gpu,
            Err(error) => {
                assert!(std::env::var_os("SANDTABLE_REQUIRE_GPU").is_none(), "{error}");
                return skipped(&format!("no GPU adapter: {error}"));
            }
        };
        *RENDERER.lock().expect("whole") = Some(PictureRenderer::new(&gpu).expect("shaders"));
        let scratch = scene("margin");
        let count = planned(&scratch, &[&SCALE[..], &["--backend", "gpu"]].concat()).len();
        let plan = Arc::new(ShardPlan::open(&scratch.at("plan")).expect("a plan"));
        let mut worker = ShardWorker::open(&plan, Some(draw)).expect("opened");
        let opened = counts();
        worker.work(0).expect("drawn");
        let first = counts();
        assert!(first[0] > opened[0] && first[1] == opened[1] + 1, "{opened:?}, then {first:?}");
        for id in 1..count {
            worker.work(id).expect("drawn");
            assert_eq!(counts(), first, "sheet {id} is drawn with what the first was");
        }
        assert_near(&(0..count).map(|id| picture(&scratch, id)).collect::<Vec<_>>());
    }
}
