//! Connections: how many are held open, and how long a silent one is.
//!
//! A client that sends its request a byte a minute, or never takes its answer, must not hold a connection for ever
//! (*slowloris*). So a connection is always in one of three states, each of which ends in time:
//!
//! ```text
//!          first byte              blank line                  first byte of the answer
//! Quiet ───────────────► Head ─────────────────► Busy ─────────────────────────────► Quiet
//! QUIET                  HEAD                    no end of its own
//! ```
//!
//! A quiet connection waits for its next request, or its client still takes the last answer; both count from the
//! answer's first byte. While a request is busy, its body and its answer have ends of their own; see
//! [`routes`](crate::app::serve::routes). Watching the bytes here needs no knowledge of HTTP but that a blank line ends a
//! head.

use std::io;
use std::net::SocketAddr;
use std::pin::Pin;
use std::task::{Context, Poll};
use std::time::Duration;

use axum::serve::Listener;
use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::net::{TcpListener, TcpStream};
use tokio::time::{Instant, Sleep};

use crate::app::serve::limits::{Permit, Turnstile};

/// How long a connection is kept that asks nothing, or whose client takes an answer: long enough for a megabyte over a
/// slow line, and for a client that asks once in a while.
const QUIET: Duration = Duration::from_secs(60);

/// How long the head of a request may take to arrive, from its first byte on: a few packets.
const HEAD: Duration = Duration::from_secs(10);

/// How long to wait where the system has no connection to give, which mostly means too many open files.
const STARVED: Duration = Duration::from_millis(100);

/// What one connection too many is told.
const FULL: &[u8] =
    b"HTTP/1.1 503 Service Unavailable\r\ncontent-type: application/json\r\nretry-after: 1\r\n\
    connection: close\r\ncontent-length: 72\r\n\r\n\
    {\"status\":\"SERVER_ERROR\",\"error\":\"too many open connections; try again\"}";

/// Takes connections, as many as may be open.
pub struct Gate {
    listener: TcpListener,
    connections: Turnstile,
}

impl Gate {
    /// Takes what comes to `listener`, at most `most` connections at a time; those beyond are told so and closed.
    pub fn new(listener: TcpListener, most: usize) -> Self {
        Self { listener, connections: Turnstile::new(most) }
    }
}

impl Listener for Gate {
    type Io = Watched;
    type Addr = SocketAddr;

    async fn accept(&mut self) -> (Watched, SocketAddr) {
        loop {
            match self.listener.accept().await {
                Ok((stream, from)) => match self.connections.enter() {
                    Some(place) => return (Watched::new(stream, place), from),
                    // Whoever does not listen is not waited for.
                    None => drop(stream.try_write(FULL)),
                },
                Err(error) if is_of_one_connection(&error) => {}
                Err(_) => tokio::time::sleep(STARVED).await,
            }
        }
    }

    fn local_addr(&self) -> io::Result<SocketAddr> {
        self.listener.local_addr()
    }
}

fn is_of_one_connection(error: &io::Error) -> bool {
    use io::ErrorKind::{ConnectionAborted, ConnectionRefused, ConnectionReset};
    matches!(error.kind(), ConnectionAborted | ConnectionRefused | ConnectionReset)
}

/// What a connection is at.
#[derive(Clone, Copy, Debug, PartialEq)]
enum State {
    Quiet { since: Instant },
    Head { since: Instant, blank: BlankLine },
    Busy,
}

/// A connection that is closed where its client takes too long.
pub struct Watched {
    stream: TcpStream,
    state: State,
    alarm: Pin<Box<Sleep>>,
    _place: Permit,
}

impl Watched {
    fn new(stream: TcpStream, place: Permit) -> Self {
        // An answer is written at once; waiting to fill a packet would only delay it.
        let _ = stream.set_nodelay(true);
        let now = Instant::now();
        let alarm = Box::pin(tokio::time::sleep_until(now + QUIET));
        Self { stream, state: State::Quiet { since: now }, alarm, _place: place }
    }

    /// Takes note of bytes that came.
    fn came(&mut self, bytes: &[u8]) {
        let (since, mut blank) = match self.state {
            State::Busy => return,
            State::Quiet { .. } => (Instant::now(), BlankLine::default()),
            State::Head { since, blank } => (since, blank),
        };
        self.state = if blank.ends_in(bytes) { State::Busy } else { State::Head { since, blank } };
    }

    /// Takes note of bytes that go.
    fn went(&mut self, bytes: &[u8]) {
        // "100 Continue" is no answer yet.
        if !matches!(self.state, State::Quiet { .. }) && !bytes.starts_with(b"HTTP/1.1 100") {
            self.state = State::Quiet { since: Instant::now() };
        }
    }

    /// Whether the client has taken too long; if not, whoever asked is woken when it has.
    fn late(&mut self, context: &mut Context<'_>) -> bool {
        let end = match self.state {
            State::Quiet { since } => since + QUIET,
            State::Head { since, .. } => since + HEAD,
            State::Busy => return false,
        };
        if self.alarm.deadline() != end {
            self.alarm.as_mut().reset(end);
        }
        self.alarm.as_mut().poll(context).is_ready()
    }

    fn unless_late<T>(&mut self, context: &mut Context<'_>) -> Poll<io::Result<T>> {
        if self.late(context) { Poll::Ready(Err(io::ErrorKind::TimedOut.into())) } else { Poll::Pending }
    }
}

impl AsyncRead for Watched {
    fn poll_read(
        self: Pin<&mut Self>,
        context: &mut Context<'_>,
        into: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        let this = self.get_mut();
        let before = into.filled().len();
        match Pin::new(&mut this.stream).poll_read(context, into) {
            Poll::Pending => this.unless_late(context),
            done => {
                let bytes = &into.filled()[before..];
                if !bytes.is_empty() {
                    this.came(bytes);
                }
                done
            }
        }
    }
}

impl AsyncWrite for Watched {
    fn poll_write(self: Pin<&mut Self>, context: &mut Context<'_>, bytes: &[u8]) -> Poll<io::Result<usize>> {
        let this = self.get_mut();
        this.went(bytes);
        match Pin::new(&mut this.stream).poll_write(context, bytes) {
            Poll::Pending => this.unless_late(context),
            done => done,
        }
    }

    fn poll_write_vectored(
        self: Pin<&mut Self>,
        context: &mut Context<'_>,
        parts: &[io::IoSlice<'_>],
    ) -> Poll<io::Result<usize>> {
        let this = self.get_mut();
        this.went(parts.first().map_or(&[], |part| part));
        match Pin::new(&mut this.stream).poll_write_vectored(context, parts) {
            Poll::Pending => this.unless_late(context),
            done => done,
        }
    }

    fn is_write_vectored(&self) -> bool {
        self.stream.is_write_vectored()
    }

    fn poll_flush(self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.get_mut().stream).poll_flush(context)
    }

    fn poll_shutdown(self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        Pin::new(&mut self.get_mut().stream).poll_shutdown(context)
    }
}

/// Finds the blank line that ends a head, in bytes that come in any pieces.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct BlankLine {
    /// Whether nothing but a carriage return has come since the last line ended; not so before the first has.
    empty: bool,
}

impl BlankLine {
    /// Whether a blank line ends in `bytes`.
    fn ends_in(&mut self, bytes: &[u8]) -> bool {
        for &byte in bytes {
            match byte {
                b'\n' if self.empty => return true,
                b'\n' => self.empty = true,
                b'\r' => {}
                _ => self.empty = false,
            }
        }
        false
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_blank_line_is_found_in_pieces_of_any_size() {
        let head = b"GET / HTTP/1.1\r\nhost: a\r\n\r\n";
        for size in 1..head.len() {
            let mut blank = BlankLine::default();
            let ends: Vec<bool> = head.chunks(size).map(|piece| blank.ends_in(piece)).collect();
            let (last, others) = ends.split_last().expect("pieces");
            assert!(*last && others.iter().all(|&end| !end), "{size}");
        }
        assert!(BlankLine::default().ends_in(b"GET / HTTP/1.1\n\n"), "bare line feeds are read too");
        assert!(!BlankLine::default().ends_in(b"GET / HTTP/1.1\r\nhost: a\r\n"));
    }

    #[test]
    fn the_refusal_of_a_connection_says_its_own_length() {
        let text = std::str::from_utf8(FULL).expect("ASCII");
        let (head, body) = text.split_once("\r\n\r\n").expect("a head");
        assert!(head.contains(&format!("content-length: {}", body.len())), "{}", body.len());
    }
}
