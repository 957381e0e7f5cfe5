//! The `sandtable` program: everything it does is in [`sandtable::app`].

use std::process::ExitCode;

fn main() -> ExitCode {
    sandtable::app::main()
}
