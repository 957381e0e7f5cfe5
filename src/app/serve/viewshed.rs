//! `/v1/viewshed`: which posts of the ground can be seen from a point.
//!
//! ```text
//! {"dataset":"a","crs":"EPSG:32610","columns":41,"rows":41,
//!  "south_west":{"x":561000.0,"y":5116000.0},"cell":{"x":30.0,"y":30.0},
//!  "counts":{"visible":612,"hidden":733,"no_data":0,"beyond":336},"visible_area_m2":550800.0,
//!  "runs":["14b13v14b", …],"status":"OK"}
//! ```
//!
//! `runs` holds a string for each row of posts from the south, each row from the west: a count, and a letter for so many
//! posts: `v` visible, `h` hidden, `n` no data, `b` beyond the range or out of the sector. The grid is the ground's, cut
//! to the square around the range; `south_west` is the position of its first post. `format=summary` leaves `runs` out.

use glam::DVec2;

use crate::app::serve::ground::{self, Grounded};
use crate::app::serve::json;
use crate::app::serve::question::{QueryRequest, Question, Service, Weight};
use crate::app::serve::reply::{BodyFormat, HttpError, Reply, quoted};
use crate::terrain::lattice::{Lattice, Post};
use crate::terrain::query::service::Snapshot;
use crate::terrain::sight::line::SightEnd;
use crate::terrain::sight::viewshed::{self, PostVisibility, Sector, ViewshedOptions};

/// Which posts can be seen from a point.
pub struct ViewshedQuestion {
    grounded: Grounded,
    /// As asked; the observer in the request's coordinates.
    options: ViewshedOptions,
    detail: ViewshedDetail,
}

/// How much of a viewshed is told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ViewshedDetail {
    /// Every post.
    Runs,
    /// The counts.
    Summary,
}

const KNOWN: [&str; 10] = [
    "dataset",
    "observer",
    "observer_height",
    "target_height",
    "range",
    "sector",
    "refraction",
    "earth",
    "format",
    "crs",
];

/// When to ask again where others' viewsheds are being looked for.
const RETRY_AFTER_S: u16 = 2;

impl Question for ViewshedQuestion {
    fn read(service: &Service, asked: &QueryRequest<'_>) -> Result<Self, HttpError> {
        let params = &asked.params;
        params.only(&KNOWN)?;
        let grounded = Grounded::read(service, params)?;
        let text = params.required("observer", "46.2,-122.19")?;
        let at = grounded.coordinates.place("observer", text)?;
        let above_m = ground::above_m(params, "observer_height", ground::OBSERVER_M)?;
        let options = ViewshedOptions {
            observer: SightEnd { at, above_m },
            target_above_m: ground::above_m(params, "target_height", 0.0)?,
            range_m: params.number("range", 0.0..=1e9, f64::INFINITY)?,
            sector: sector(params.get("sector"))?,
            curvature: ground::curvature(params)?,
        };
        let details = [("runs", ViewshedDetail::Runs), ("summary", ViewshedDetail::Summary)];
        let detail = params.choice("format", &details)?.unwrap_or(ViewshedDetail::Runs);
        Ok(Self { grounded, options, detail })
    }

    fn weight(&self, _: &Service) -> Weight {
        Weight::Heavy
    }

    fn answer(self, service: &Service) -> Result<Reply, HttpError> {
        let _place = service.viewsheds.enter().ok_or_else(|| {
            HttpError::busy(RETRY_AFTER_S, "other viewsheds are being looked for; ask again")
        })?;
        let epoch = self.grounded.epoch(service)?;
        let lattice = epoch.lattice();
        let at = self.grounded.coordinates.bring("observer", self.options.observer.at, epoch.crs())?;
        let window = PostWindow::around(lattice, at, self.options.range_m);
        window.check(lattice, service.limits.max_posts)?;
        let observer = SightEnd { at, ..self.options.observer };
        let seen =
            viewshed::viewshed(lattice, &ViewshedOptions { observer, ..self.options }).map_err(|answer| {
                HttpError::wrong(format!("observer: there is no ground there ({})", answer.status()))
            })?;
        let mut body = Vec::with_capacity(1024);
        self.write(service, &epoch, &window, &seen, &mut body);
        Ok(Reply { form: BodyFormat::Json, body })
    }
}

/// `FROM,WIDTH`: where it begins, clockwise from north, and how far it turns.
fn sector(text: Option<&str>) -> Result<Sector, HttpError> {
    let Some(text) = text else {
        return Ok(Sector::ALL);
    };
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

/// The posts that a viewshed is told of.
struct PostWindow {
    first: Post,
    last: Post,
}

impl PostWindow {
    /// The posts within `range_m` of `at` eastward and northward; those of the border where there are none.
    fn around(lattice: &Lattice, at: DVec2, range_m: f64) -> Self {
        let grid = lattice.grid_at(at - lattice.origin());
        let reach = DVec2::splat(range_m) / lattice.cell();
        let most = DVec2::new(f64::from(lattice.columns() - 1), f64::from(lattice.rows() - 1));
        let post = |grid: DVec2| {
            let inside = grid.clamp(DVec2::ZERO, most);
            Post { column: inside.x as u32, row: inside.y as u32 }
        };
        // Rounded outward, so that no rounding leaves out a post right at the range.
        Self { first: post((grid - reach).floor()), last: post((grid + reach).ceil()) }
    }

    fn columns(&self) -> u32 {
        self.last.column.saturating_sub(self.first.column) + 1
    }

    fn rows(&self) -> u32 {
        self.last.row.saturating_sub(self.first.row) + 1
    }

    fn check(&self, lattice: &Lattice, most: u32) -> Result<(), HttpError> {
        let posts = u64::from(self.columns()) * u64::from(self.rows());
        if posts <= u64::from(most) {
            return Ok(());
        }
        // A square has two cells for each of the range, and up to three posts more.
        let range = 0.5 * (f64::from(most).sqrt() - 3.0) * lattice.cell().min_element();
        Err(HttpError::wrong(format!(
            "the viewshed would have {posts} posts, {most} are the most of one request; ask for range={:.0} or less",
            range.max(0.0).floor()
        )))
    }
}

impl ViewshedQuestion {
    fn write(
        &self,
        service: &Service,
        epoch: &Snapshot,
        window: &PostWindow,
        seen: &viewshed::Viewshed,
        out: &mut Vec<u8>,
    ) {
        let lattice = epoch.lattice();
        json::raw(out, "{\"dataset\":");
        out.extend_from_slice(&service.datasets.at(self.grounded.dataset).name_json);
        json::raw(out, ",\"crs\":");
        json::string(out, epoch.crs().name());
        for (name, value) in [(",\"columns\":", window.columns()), (",\"rows\":", window.rows())] {
            json::raw(out, name);
            json::whole(out, value.into());
        }
        write_pair(out, ",\"south_west\":{\"x\":", lattice.map_position(window.first));
        write_pair(out, ",\"cell\":{\"x\":", lattice.cell());
        let counts = counts(seen);
        let names = [",\"counts\":{\"visible\":", ",\"hidden\":", ",\"no_data\":", ",\"beyond\":"];
        let told = window_total(window, &counts);
        for (name, count) in names.into_iter().zip(told) {
            json::raw(out, name);
            json::whole(out, count);
        }
        json::raw(out, "},\"visible_area_m2\":");
        json::number(out, told[0] as f64 * lattice.cell().element_product());
        if self.detail == ViewshedDetail::Runs {
            write_runs(window, seen, out);
        }
        json::raw(out, ",\"status\":\"OK\"}");
    }
}

fn write_pair(out: &mut Vec<u8>, name: &str, pair: DVec2) {
    json::raw(out, name);
    json::number(out, pair.x);
    json::raw(out, ",\"y\":");
    json::number(out, pair.y);
    json::raw(out, "}");
}

/// How many posts are visible, hidden and without data: all of them lie in the window.
fn counts(seen: &viewshed::Viewshed) -> [u64; 3] {
    let mut counts = [0; 3];
    for &post in &seen.posts {
        match post {
            PostVisibility::Visible => counts[0] += 1,
            PostVisibility::Hidden => counts[1] += 1,
            PostVisibility::NoData => counts[2] += 1,
            PostVisibility::Beyond => {}
        }
    }
    counts
}

/// The counts with the posts of the window that lie beyond.
fn window_total(window: &PostWindow, [visible, hidden, no_data]: &[u64; 3]) -> [u64; 4] {
    let posts = u64::from(window.columns()) * u64::from(window.rows());
    [*visible, *hidden, *no_data, posts.saturating_sub(visible + hidden + no_data)]
}

fn write_runs(window: &PostWindow, seen: &viewshed::Viewshed, out: &mut Vec<u8>) {
    json::raw(out, ",\"runs\":[");
    for row in 0..window.rows() {
        let from = (window.first.row + row) as usize * seen.columns as usize + window.first.column as usize;
        json::raw(out, if row == 0 { "\"" } else { ",\"" });
        for run in seen.posts[from..from + window.columns() as usize].chunk_by(|a, b| a == b) {
            json::whole(out, run.len() as u64);
            out.push(letter(run[0]));
        }
        json::raw(out, "\"");
    }
    json::raw(out, "]");
}

fn letter(seen: PostVisibility) -> u8 {
    match seen {
        PostVisibility::Visible => b'v',
        PostVisibility::Hidden => b'h',
        PostVisibility::NoData => b'n',
        PostVisibility::Beyond => b'b',
    }
}
