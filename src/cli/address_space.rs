//! The address space that `ulimit -v` leaves: a command that cannot succeed within it is refused before it begins.
//!
//! An allocation that fails ends a program by a signal. What is large is asked for by
//! [its size](sandtable_base::limits::memory); what is small is asked for here, all together: each command has a floor of what it was
//! measured to need beside that, and uses no more threads than fit above it.
//!
//! The C library GNU gives each thread an arena of its own, which takes 128 MiB of addresses while it is made and 64 MiB after,
//! whatever is used of it. Under a limit those run out long before memory does. So this program starts itself again with one
//! arena for all threads, by `MALLOC_ARENA_MAX=1`, where a limit does not hold them all: it stays the same process, with the
//! same arguments, files and signals, and draws the same picture.

use std::fs;

use crate::arguments::{Command, DemCommand};
use crate::error::CliError;
use crate::invocation::RestartCommand;
use crate::threads;

const MIB: u64 = 1 << 20;

/// What a thread takes: its stack, and some for its own lists.
const PER_THREAD: u64 = 3 * MIB;

/// What the arena of a thread takes while it is made.
#[cfg(any(test, all(target_os = "linux", target_env = "gnu")))]
const ARENA: u64 = 128 * MIB;

/// The threads besides those that compute: the first one, and one that waits for signals.
const OTHER_THREADS: u64 = 2;

/// What a command needs beside the program itself and its threads, in MiB; `None` where it needs hardly anything.
///
/// Measured as the least limit under which a command succeeds, less that of `--version`, with the demo: 4 for heights, 16 for a
/// chart, 39 for a viewshed, 42 to check the scene, 62 to draw 320 × 180 pixels, 98 to draw frames of a flight, 104 to 124 to
/// export it, 222 as a page. Rounded up by a tenth or more: other scenes have other small lists. A service has threads of its own.
fn floor_of(command: &Command) -> Option<u64> {
    match command {
        Command::Explain(_)
        | Command::Schema
        | Command::Catalog
        | Command::Completions(_)
        | Command::Licenses => None,
        Command::Export(arguments) if arguments.is_page() => Some(245),
        Command::Export(_) => Some(140),
        Command::Fly(_) => Some(110),
        Command::Render(_) | Command::Demo(_) | Command::View(_) | Command::Pick(_) | Command::Work(_) => {
            Some(75)
        }
        Command::Check(_)
        | Command::Report(_)
        | Command::New(_)
        | Command::Serve(_)
        | Command::Viewshed(_)
        | Command::Analyze(_)
        | Command::Plan { .. }
        | Command::Gather(_) => Some(50),
        Command::Profile(_) | Command::Los(_) | Command::Symbol(_) => Some(25),
        Command::Dem { command: DemCommand::Info(_) | DemCommand::Convert(_) | DemCommand::Grid(_) }
        | Command::Model { .. }
        | Command::Height(_)
        | Command::Mesh(_)
        | Command::Lod(_) => Some(12),
    }
}

/// The number of threads for a command: the number it asks for, or one per processor, but no more than fit into the available
/// address space.
///
/// # Errors
/// The command does not fit with one thread.
pub fn threads_for(command: &Command, restart: Option<&RestartCommand>) -> Result<usize, CliError> {
    let wanted = match command {
        Command::Render(arguments) => threads::wanted(arguments.threads.map(usize::from)),
        _ => threads::wanted(None),
    };
    let (Some(floor), Some(space)) = (floor_of(command), AddressSpace::of_this_process()) else {
        return Ok(wanted);
    };
    let threads = |arena| space.threads(wanted, floor * MIB, arena);
    threads(arena_bytes(|arena| threads(arena).is_ok_and(|count| count == wanted), restart))
}

/// What the arena of each thread takes; where `fits` does not hold for that, the program starts itself again with one.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
fn arena_bytes(fits: impl Fn(u64) -> bool, restart: Option<&RestartCommand>) -> u64 {
    use std::env;
    use std::os::unix::process::CommandExt;

    const ARENAS: &str = "MALLOC_ARENA_MAX";
    match env::var_os(ARENAS) {
        Some(most) if most == "1" => return 0,
        Some(_) => return ARENA,
        None => {}
    }
    if let (false, Some(restart)) = (fits(ARENA), restart) {
        // It returns only where the system refuses: then the arenas stay.
        let _ = restart.command().env(ARENAS, "1").exec();
    }
    ARENA
}

#[cfg(not(all(target_os = "linux", target_env = "gnu")))]
fn arena_bytes(_: impl Fn(u64) -> bool, _: Option<&RestartCommand>) -> u64 {
    0
}

/// The address space of this process in bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AddressSpace {
    /// The most that it may have.
    most: u64,
    /// What it has.
    used: u64,
}

impl AddressSpace {
    /// The limit of this process; `None` where it is not limited, or the system does not report it.
    pub fn of_this_process() -> Option<Self> {
        let read = |file: &str| fs::read_to_string(format!("/proc/self/{file}")).ok();
        Self::parse(&read("limits")?, &read("status")?)
    }

    /// The most bytes that the process may have.
    #[cfg(unix)]
    pub fn most(&self) -> u64 {
        self.most
    }

    /// From the tables of limits and of the status of a process, as Linux writes them.
    fn parse(limits: &str, status: &str) -> Option<Self> {
        let number = |text: &str| text.split_whitespace().next()?.parse::<u64>().ok();
        let after = |table: &str, name: &str| table.lines().find_map(|line| number(line.strip_prefix(name)?));
        Some(Self { most: after(limits, "Max address space")?, used: after(status, "VmSize:")? * 1024 })
    }

    /// How many of the wanted threads fit beside `floor` bytes, with an arena of so many bytes each. They take half of what is
    /// left at the most, so that a larger scene has the other half.
    ///
    /// # Errors
    /// Not even one does.
    fn threads(&self, wanted: usize, floor: u64, arena: u64) -> Result<usize, CliError> {
        let each = PER_THREAD + arena;
        let fixed = floor + OTHER_THREADS * each;
        let left = self.most.saturating_sub(self.used).saturating_sub(fixed);
        if left >= each {
            let fitting = usize::try_from(left / 2 / each).unwrap_or(usize::MAX).max(1);
            return Ok(wanted.min(fitting));
        }
        let needed = self.used + fixed + each;
        Err(CliError::input(format!(
            "this command needs {} MB of address space with one thread, and `ulimit -v` lets it have {} MB; allow it more, for \
             example with: ulimit -v {}",
            needed.div_ceil(1_000_000),
            self.most / 1_000_000,
            needed.div_ceil(1024)
        )))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMITS: &str = "Limit                     Soft Limit           Hard Limit           Units     \n\
                          Max resident set          unlimited            unlimited            bytes     \n\
                          Max address space         204800000            unlimited            bytes     \n";
    const STATUS: &str = "Name:\tsandtable\nVmPeak:\t   60000 kB\nVmSize:\t   50000 kB\n";

    #[test]
    fn what_the_system_tells_is_read_and_no_limit_is_none() {
        let space = AddressSpace { most: 204_800_000, used: 51_200_000 };
        assert_eq!(AddressSpace::parse(LIMITS, STATUS), Some(space));
        assert_eq!(AddressSpace::parse(&LIMITS.replace("204800000", "unlimited"), STATUS), None);
        assert_eq!(AddressSpace::parse("", ""), None);
        assert_eq!(AddressSpace::parse(LIMITS, "Name:\tsandtable\n"), None);
    }

    #[test]
    fn threads_are_as_many_as_fit_and_at_least_one() {
        let of = |megabytes: u64| AddressSpace { most: megabytes * MIB, used: 50 * MIB };
        let threads = |megabytes, arena| of(megabytes).threads(16, 75 * MIB, arena).ok();
        // 50 of the program, 75 of the command, 6 of two threads, 3 of each further one.
        assert_eq!(
            [133, 134, 142, 143, 5000].map(|most| threads(most, 0)),
            [None, Some(1), Some(1), Some(2), Some(16)]
        );
        assert_eq!([517, 518, 5000].map(|most| threads(most, ARENA)), [None, Some(1), Some(16)]);
        let refused = of(100).threads(4, 75 * MIB, 0).err();
        let Some(CliError::Input { error, .. }) = refused else { panic!("an error of the input") };
        let said = error.to_string();
        assert!(
            said.contains("needs 141 MB")
                && said.contains("have 104 MB")
                && said.ends_with("ulimit -v 137216"),
            "{said}"
        );
        assert!(of(40).threads(4, 0, 0).is_err());
    }
}
