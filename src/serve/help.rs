//! `/`: the queries, as plain text.

use axum::response::{IntoResponse, Response};

use crate::serve::query::Service;

pub fn page(service: &Service) -> Response {
    let names = service.datasets.names();
    let first = &service.datasets.at(0).name;
    let points = service.limits.max_points;
    let text = format!(
        "\
sandtable {version}: heights over HTTP

Datasets: {names}

GET or POST /v1/DATASET             heights; compatible with the Open Topo Data API; a,b: the first that has one
    locations=LAT,LNG|LAT,LNG       at most {points}; or an encoded polyline
    interpolation=bilinear          nearest, planar, cubic, distance-weighted
    samples=N                       N places at equal distances along the path of the locations
    nodata_value=null               nan, or a number: the elevation where there is none
    format=json                     geojson
    surface=source|ground|scene     as read; in meters, after earthworks; decks on top [of a file source, else ground]
    crs=EPSG:N                      locations are x,y of that system; crs=native: of the dataset's own
GET or POST /v1/los                 whether one point can be seen from another
    dataset, from, to, observer_height=2, target_height=0, refraction=0.142857, earth=round|flat, crs
GET or POST /v1/profile             the ground along a line, at every place where it bends
    dataset, locations, crs
GET or POST /v1/viewshed            what can be seen from a point
    dataset, observer, observer_height=2, target_height=0, range=METERS, sector=FROM,WIDTH (degrees from north),
    refraction, earth, format=runs|summary, crs
GET /health                         version, datasets with their systems and extents

A POST takes the same parameters as a form or as a JSON object. Heights and distances are meters. A refusal is JSON
with status and error.

Example: /v1/{first}?locations=46.2,-122.19
",
        version = env!("CARGO_PKG_VERSION"),
    );
    text.into_response()
}
