//! The checks every mesh must pass.
