//! `/v1/viewshed`: which posts of the ground can be seen from a point.
//!
//! ```text
//! {"dataset":"a","crs":"EPSG:32610","columns":41,"rows":41,
//!  "south_west":{"x":561000.0,"y":5116000.0},"cell":{"x":30.0,"y":30.0},
//!  "counts":{"visible":612,"hidden":733,"no_data":0,"beyond":336},"visible_area_m2":550800.0,
//!  "runs":["14b13v14b", …],"status":"OK"}
//! ```
//!
//! `runs` holds a string for each row of posts from the south, each row from the west: a count, and a letter for that
//! many posts: `v` visible, `h` hidden, `n` no data, `b` beyond the range or out of the sector. The grid is the
//! ground's, cut to the square around the range; `south_west` is the position of its first post. `format=summary`
//! leaves `runs` out.

use std::fmt::Write;

use axum::Json;
use axum::response::{IntoResponse, Response};
use glam::DVec2;
use serde::Serialize;

use crate::api;
use crate::coordinates::Location;
use crate::parameters::Parameters;
use crate::query::{GroundQuery, OBSERVER_M, Query, QueryWeight, above_m, curvature};
use crate::reply::{HttpError, OK, quoted};
use crate::service::Service;
use sandtable_terrain::lattice::{Lattice, Post};
use sandtable_terrain::post_rect::PostRect;
use sandtable_terrain::sight::line::SightEnd;
use sandtable_terrain::sight::viewshed::{
    self, PostVisibility, Sector, Viewshed, ViewshedCounts, ViewshedOptions,
};
use sandtable_terrain::stop_flag::StopFlag;

/// The size of a post in `runs`, at most: where no two neighbors are alike.
const POST_BYTES: usize = 2;

pub struct ViewshedQuery {
    ground: GroundQuery,
    /// The options, with the observer in the request's coordinates.
    options: ViewshedOptions,
    detail: ViewshedDetail,
}

/// How much of a viewshed is answered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ViewshedDetail {
    /// Every post.
    Runs,
    /// The counts.
    Summary,
}

#[derive(Serialize)]
struct ViewshedAnswer<'a> {
    dataset: &'a str,
    crs: &'a str,
    columns: u32,
    rows: u32,
    south_west: Location,
    cell: Location,
    counts: ViewshedCounts,
    visible_area_m2: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    runs: Option<Vec<String>>,
    status: &'static str,
}

impl Query for ViewshedQuery {
    fn read(service: &Service, _: &str, parameters: &Parameters) -> Result<Self, HttpError> {
        let ground = GroundQuery::read(service, parameters, &api::VIEWSHED.names())?;
        let text = parameters.required("observer", "46.2,-122.19")?;
        let at = ground.coordinates.position("observer", text)?;
        let above = above_m(parameters, "observer_height", OBSERVER_M)?;
        let options = ViewshedOptions {
            observer: SightEnd { at, above_m: above },
            target_above_m: above_m(parameters, "target_height", 0.0)?,
            range_m: parameters.number("range", 0.0..=1e9, f64::INFINITY)?,
            sector: sector(parameters.get("sector"))?,
            curvature: curvature(parameters)?,
        };
        let details = [("runs", ViewshedDetail::Runs), ("summary", ViewshedDetail::Summary)];
        let detail = parameters.word("format", details)?.unwrap_or(ViewshedDetail::Runs);
        Ok(Self { ground, options, detail })
    }

    fn weight(&self, _: &Service) -> QueryWeight {
        QueryWeight::Expensive
    }

    fn most_bytes(&self, service: &Service) -> usize {
        let source = self.ground.served(service).dataset.header();
        let posts = 2 * source.width as usize * source.height as usize;
        match self.detail {
            ViewshedDetail::Runs => posts.min(service.limits.max_posts as usize) * POST_BYTES,
            ViewshedDetail::Summary => 0,
        }
    }

    fn answer(self, service: &Service, stop: &StopFlag) -> Result<Response, HttpError> {
        let served = self.ground.served(service);
        let observer_at = [self.options.observer.at];
        // The answer's size is known before the ground within the range is read.
        let here = served.ground(&self.ground.reach(&observer_at, 0.0))?;
        let at = self.ground.to_ground("observer", observer_at[0], &here)?;
        let window = PostWindow::around(&here.lattice, at, self.options.range_m);
        window.check(&here.lattice, service.limits.max_posts)?;
        let ground = served.ground(&self.ground.reach(&observer_at, self.options.range_m))?;
        let part = window.part(&ground.lattice);
        let lattice = part.as_ref().unwrap_or(&ground.lattice);
        let observer = SightEnd { at, ..self.options.observer };
        let options = ViewshedOptions { observer, ..self.options };
        let viewshed = viewshed::viewshed_until(lattice, &options, stop).map_err(|answer| {
            HttpError::wrong(format!("observer: there is no ground there ({})", answer.status()))
        })?;
        let viewshed = viewshed.ok_or_else(HttpError::stopped)?;
        let counts = window.counts(&viewshed);
        let south_west = lattice.map_position(window.0.first);
        let position = self.ground.coordinates.written(&ground.crs, south_west);
        let xy = |DVec2 { x, y }: DVec2, position| Location::Xy { x, y, position };
        Ok(Json(ViewshedAnswer {
            dataset: &served.name,
            crs: ground.crs.name(),
            columns: window.0.width() as u32,
            rows: window.0.height() as u32,
            south_west: xy(south_west, position),
            cell: xy(lattice.cell(), None),
            visible_area_m2: counts.visible as f64 * lattice.cell().element_product(),
            counts,
            runs: (self.detail == ViewshedDetail::Runs).then(|| window.runs(&viewshed, lattice.held().first)),
            status: OK,
        })
        .into_response())
    }
}

/// Parses `FROM,WIDTH`: where a sector begins, clockwise from north, and how far it turns.
fn sector(text: Option<&str>) -> Result<Sector, HttpError> {
    let Some(text) = text else { return Ok(Sector::ALL) };
    let numbers = text.split_once(',').and_then(|(from, width)| {
        Some((from.trim().parse::<f64>().ok()?, width.trim().parse::<f64>().ok()?))
    });
    match numbers {
        Some((from_deg, width_deg))
            if (-360.0..=360.0).contains(&from_deg) && width_deg > 0.0 && width_deg <= 360.0 =>
        {
            Ok(Sector { from_deg: from_deg.rem_euclid(360.0), width_deg })
        }
        _ => Err(HttpError::wrong(format!(
            "sector is {}; write FROM,WIDTH in degrees clockwise from north, as in 45,90 for the north-east to the \
             south-east",
            quoted(text)
        ))),
    }
}

/// The posts of an answer.
struct PostWindow(PostRect);

impl PostWindow {
    /// The posts within `range_m` of `at` eastward and northward; those of the border where there are none.
    fn around(lattice: &Lattice, at: DVec2, range_m: f64) -> Self {
        let grid = lattice.grid_at(at - lattice.origin());
        let reach = DVec2::splat(range_m) / lattice.cell();
        let most = lattice.last_grid();
        let post = |grid: DVec2| Post::at_grid(grid.clamp(DVec2::ZERO, most));
        // Rounded outward, so that rounding leaves out no post right at the range.
        Self(PostRect { first: post((grid - reach).floor()), last: post((grid + reach).ceil()) })
    }

    /// The ground around these posts alone, where it is less than half of what is held: a viewshed sets up a state for each post
    /// that is held.
    fn part(&self, lattice: &Lattice) -> Option<Lattice> {
        /// Posts beside the range that its lines may meet.
        const BESIDE: u32 = 4;
        let around = self.0.grown((BESIDE, BESIDE), lattice);
        let is_little = 2 * around.width() * around.height() < lattice.held_heights().len();
        (lattice.holds_all() && is_little).then(|| lattice.holding_only(around))
    }

    fn posts(&self) -> usize {
        self.0.width() * self.0.height()
    }

    fn check(&self, lattice: &Lattice, most: u32) -> Result<(), HttpError> {
        let posts = self.posts();
        if posts as u64 <= u64::from(most) {
            return Ok(());
        }
        // A square has two cells for each of the range, and up to three posts more.
        let range = 0.5 * (f64::from(most).sqrt() - 3.0) * lattice.cell().min_element();
        Err(HttpError::wrong(format!(
            "the viewshed would have {posts} posts, {most} are the most of one request; ask for range={:.0} or less",
            range.max(0.0).floor()
        )))
    }

    /// The posts of each kind; all that are not beyond lie in the window.
    fn counts(&self, viewshed: &Viewshed) -> ViewshedCounts {
        let all = viewshed.counts();
        let looked_at = all.visible + all.hidden + all.no_data;
        ViewshedCounts { beyond: self.posts().saturating_sub(looked_at), ..all }
    }

    /// The runs of a viewshed whose first post is `first`.
    fn runs(&self, viewshed: &Viewshed, first: Post) -> Vec<String> {
        let row = |row: u32| {
            let (column, row) = (self.0.first.column - first.column, row - first.row);
            let from = row as usize * viewshed.columns as usize + column as usize;
            let posts = &viewshed.posts[from..from + self.0.width()];
            posts.chunk_by(|a, b| a == b).fold(String::new(), |mut runs, run| {
                let _ = write!(runs, "{}{}", run.len(), letter(run[0]));
                runs
            })
        };
        (self.0.first.row..=self.0.last.row).map(row).collect()
    }
}

fn letter(post: PostVisibility) -> char {
    match post {
        PostVisibility::Visible => 'v',
        PostVisibility::Hidden => 'h',
        PostVisibility::NoData => 'n',
        PostVisibility::Beyond => 'b',
    }
}
