//! SQLite databases as files to read: GeoPackages of features and of rasters.
//!
//! A database is a program as much as data: views are queries, and they may run for ever. It is opened from memory and
//! read only, without extensions or functions that have side effects, with limits on the length of values and
//! statements, and it is stopped after more steps than real files take.
//!
//! ```
//! use sandtable_database::open;
//! assert!(open(b"SQLite format 3\0").and_then(|database| database.query_row("SELECT 1", [], |_| Ok(()))).is_err());
//! ```

use std::io::Read;
use std::ops::Range;

use rusqlite::Connection;
use rusqlite::limits::Limit;

/// Steps of SQLite's virtual machine between two looks at their number.
const STEPS_BETWEEN_CHECKS: i32 = 100_000;
/// Steps that any file may take: a second or two.
const FREE_STEPS: u64 = 100_000_000;
/// Steps for each byte of the file, of which reading takes less than one.
const STEPS_PER_BYTE: u64 = 10;

/// The database that these bytes are, which takes as much memory again.
///
/// # Errors
/// SQLite's; a query that takes more steps than any real file fails with
/// [`OperationInterrupted`](rusqlite::ErrorCode::OperationInterrupted).
pub fn open(bytes: &[u8]) -> rusqlite::Result<Connection> {
    let mut connection = Connection::open_in_memory()?;
    let longest_value = i32::try_from(bytes.len()).unwrap_or(i32::MAX).max(1 << 20);
    let limits = [
        (Limit::SQLITE_LIMIT_LENGTH, longest_value),
        (Limit::SQLITE_LIMIT_SQL_LENGTH, 1 << 20),
        (Limit::SQLITE_LIMIT_EXPR_DEPTH, 100),
        (Limit::SQLITE_LIMIT_COMPOUND_SELECT, 50),
        (Limit::SQLITE_LIMIT_ATTACHED, 0),
        (Limit::SQLITE_LIMIT_TRIGGER_DEPTH, 1),
        (Limit::SQLITE_LIMIT_WORKER_THREADS, 0),
    ];
    connection.deserialize_read_exact("main", without_log(bytes), bytes.len(), true)?;
    for (limit, value) in limits {
        connection.set_limit(limit, value)?;
    }
    let max_steps = FREE_STEPS.saturating_add(STEPS_PER_BYTE.saturating_mul(bytes.len() as u64));
    let mut checks_left = max_steps / STEPS_BETWEEN_CHECKS.unsigned_abs() as u64;
    let is_exhausted = move || {
        checks_left = checks_left.saturating_sub(1);
        checks_left == 0
    };
    connection.progress_handler(STEPS_BETWEEN_CHECKS, Some(is_exhausted))?;
    connection
        .execute_batch("PRAGMA trusted_schema = OFF; PRAGMA query_only = ON; PRAGMA cell_size_check = ON;")?;
    Ok(connection)
}

/// A name as SQL writes it.
pub fn quoted(name: &str) -> String {
    format!("\"{}\"", name.replace('"', "\"\""))
}

/// The database marked as one without a write-ahead log (database file format, section 1.3: bytes 18 and 19), since no
/// log lies beside it in memory. Changes that are only in such a log are not seen.
fn without_log(bytes: &[u8]) -> impl Read {
    const VERSIONS: Range<usize> = 18..20;
    const NO_LOG: [u8; 2] = [1, 1];
    let before = &bytes[..bytes.len().min(VERSIONS.start)];
    let after = bytes.get(VERSIONS.end..).unwrap_or_default();
    before.chain(&NO_LOG[..]).chain(after)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_database_is_read_and_never_written() {
        let mut made = Connection::open_in_memory().expect("memory");
        made.execute_batch("CREATE TABLE a (b); INSERT INTO a VALUES (7)").expect("sound SQL");
        let bytes = made.serialize("main").expect("memory").to_vec();
        let opened = open(&bytes).expect("a database");
        assert_eq!(opened.query_row("SELECT b FROM a", [], |row| row.get::<_, i64>(0)), Ok(7));
        assert!(opened.execute_batch("INSERT INTO a VALUES (8)").is_err());
        let endless = "WITH RECURSIVE n(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM n) SELECT max(x) FROM n";
        assert!(opened.query_row(endless, [], |_| Ok(())).is_err(), "it is stopped");
    }

    #[test]
    fn names_are_quoted() {
        assert_eq!(quoted("a \"b\""), "\"a \"\"b\"\"\"");
    }
}
