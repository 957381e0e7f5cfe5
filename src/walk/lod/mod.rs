//! Methods of showing an elevation model, compared on the same flight.
//!
//! Every method flies the same cameras and reports the same things: what it shows, what changed, what it sends, how
//! long it takes, how far it is off. [`method`] lists the methods; each kind of method is a file that implements
//! [`follower::LodFollower`], and [`method_follower`] puts them to work.

pub mod deferred;
pub mod flight_path;
pub mod flight_run;
pub mod follower;
pub mod full;
pub mod geomipmap;
pub mod index_lists;
pub mod lod_ground;
pub mod method;
pub mod method_follower;
pub mod patch_lists;
pub mod refining;
pub mod station_file;
