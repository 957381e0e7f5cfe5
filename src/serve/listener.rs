//! Limits the number of open connections and the time that an idle one stays open.
//!
//! A client that sends its request a byte a minute, or never reads the answer, must not hold a connection forever
//! (*slowloris*). Neither `axum` nor `tower-http` has access to the bytes of a request's head or to the sockets, so
//! this module wraps them. A connection is always in one of three phases:
//!
//! ```text
//!          first byte              blank line                  first byte of the answer
//! Quiet ───────────────► Head ─────────────────► Busy ─────────────────────────────► Quiet
//! 60 s                   10 s                    no limit here
//! ```
//!
//! A quiet connection waits for its next request, or its client is still reading the last answer; the time of both
//! counts from the first byte of the answer. While a request is busy, [`parameters`](crate::parameters) limits
//! its body and [`router`](crate::router) its answer.

use std::io;
use std::net::SocketAddr;
use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll};
use std::time::Duration;

use axum::extract::connect_info::Connected;
use axum::serve::{IncomingStream, Listener};
use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use tokio::net::{TcpListener, TcpStream};
use tokio::time::{Instant, Sleep};

use crate::clients::{Clients, Connection, OpenConnection};

/// The time limit of a quiet connection: a megabyte over a slow line, and a pause between requests.
const QUIET: Duration = Duration::from_secs(60);

/// The time limit of a head, from its first byte on: a few packets.
const HEAD: Duration = Duration::from_secs(10);

/// The pause after `accept` fails, mostly because too many files are open.
const PAUSE: Duration = Duration::from_millis(100);

/// The answer to one connection too many.
const FULL: &[u8] =
    b"HTTP/1.1 503 Service Unavailable\r\ncontent-type: application/json\r\nretry-after: 1\r\n\
    connection: close\r\ncontent-length: 72\r\n\r\n\
    {\"status\":\"SERVER_ERROR\",\"error\":\"too many open connections; try again\"}";

/// Accepts connections, as many as [`Clients`] admits.
pub struct Gate {
    listener: TcpListener,
    clients: Arc<Clients>,
}

impl Gate {
    /// Accepts connections of `clients`; others are refused and closed.
    pub fn new(listener: TcpListener, clients: Arc<Clients>) -> Self {
        Self { listener, clients }
    }
}

/// The connection over which a request came.
#[derive(Clone, Debug)]
pub struct RequestConnection(pub Arc<Connection>);

impl Connected<IncomingStream<'_, Gate>> for RequestConnection {
    fn connect_info(stream: IncomingStream<'_, Gate>) -> Self {
        Self(Arc::clone(&stream.io().open.connection))
    }
}

impl Listener for Gate {
    type Io = TimedStream;
    type Addr = SocketAddr;

    async fn accept(&mut self) -> (TimedStream, SocketAddr) {
        use io::ErrorKind::{ConnectionAborted, ConnectionRefused, ConnectionReset};
        loop {
            match self.listener.accept().await {
                Ok((stream, from)) => match self.clients.admit(from.ip()) {
                    Some(open) => return (TimedStream::new(stream, open), from),
                    // Does not block on a client that does not read.
                    None => drop(stream.try_write(FULL)),
                },
                // The error concerns one connection, which is closed.
                Err(error)
                    if matches!(error.kind(), ConnectionAborted | ConnectionRefused | ConnectionReset) => {}
                Err(_) => tokio::time::sleep(PAUSE).await,
            }
        }
    }

    fn local_addr(&self) -> io::Result<SocketAddr> {
        self.listener.local_addr()
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum ConnectionPhase {
    Quiet,
    Head(BlankLine),
    Busy,
}

/// A connection that is closed where its client takes too long.
pub struct TimedStream {
    stream: TcpStream,
    phase: ConnectionPhase,
    /// The end of the phase; not used while busy.
    end: Instant,
    alarm: Pin<Box<Sleep>>,
    open: OpenConnection,
}

impl TimedStream {
    fn new(stream: TcpStream, open: OpenConnection) -> Self {
        // An answer is written at once; waiting to fill a packet would only delay it.
        let _ = stream.set_nodelay(true);
        let end = Instant::now() + QUIET;
        let alarm = Box::pin(tokio::time::sleep_until(end));
        Self { stream, phase: ConnectionPhase::Quiet, end, alarm, open }
    }

    fn received(&mut self, bytes: &[u8]) {
        let mut blank = match self.phase {
            ConnectionPhase::Busy => return,
            ConnectionPhase::Head(blank) => blank,
            ConnectionPhase::Quiet => {
                self.end = Instant::now() + HEAD;
                BlankLine::default()
            }
        };
        let ends = blank.ends_in(bytes);
        self.phase = if ends { ConnectionPhase::Busy } else { ConnectionPhase::Head(blank) };
        self.open.connection.set_busy(ends);
    }

    fn sent(&mut self, bytes: &[u8]) {
        // "100 Continue" is no answer yet.
        if self.phase != ConnectionPhase::Quiet && !bytes.starts_with(b"HTTP/1.1 100") {
            self.phase = ConnectionPhase::Quiet;
            self.end = Instant::now() + QUIET;
            self.open.connection.set_busy(false);
        }
    }

    /// Fails where the connection was closed in favor of another.
    fn check_open(&self, context: &Context<'_>) -> io::Result<()> {
        match self.open.connection.is_closed(context.waker()) {
            true => Err(io::ErrorKind::ConnectionAborted.into()),
            false => Ok(()),
        }
    }

    /// Fails after the end of the phase; before it, wakes the task then.
    fn poll_end<T>(&mut self, context: &mut Context<'_>) -> Poll<io::Result<T>> {
        if self.phase == ConnectionPhase::Busy {
            return Poll::Pending;
        }
        if self.alarm.deadline() != self.end {
            self.alarm.as_mut().reset(self.end);
        }
        self.alarm.as_mut().poll(context).map(|()| Err(io::ErrorKind::TimedOut.into()))
    }
}

impl AsyncRead for TimedStream {
    fn poll_read(
        self: Pin<&mut Self>,
        context: &mut Context<'_>,
        into: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        let this = self.get_mut();
        this.check_open(context)?;
        let before = into.filled().len();
        match Pin::new(&mut this.stream).poll_read(context, into) {
            Poll::Pending => this.poll_end(context),
            done => {
                let bytes = &into.filled()[before..];
                if !bytes.is_empty() {
                    this.open.connection.moved(bytes.len());
                    this.received(bytes);
                }
                done
            }
        }
    }
}

impl AsyncWrite for TimedStream {
    fn poll_write(self: Pin<&mut Self>, context: &mut Context<'_>, bytes: &[u8]) -> Poll<io::Result<usize>> {
        self.poll_write_vectored(context, &[io::IoSlice::new(bytes)])
    }

    fn poll_write_vectored(
        self: Pin<&mut Self>,
        context: &mut Context<'_>,
        parts: &[io::IoSlice<'_>],
    ) -> Poll<io::Result<usize>> {
        let this = self.get_mut();
        this.check_open(context)?;
        this.sent(parts.first().map_or(&[], |part| part));
        match Pin::new(&mut this.stream).poll_write_vectored(context, parts) {
            Poll::Pending => this.poll_end(context),
            done => {
                if let Poll::Ready(Ok(bytes)) = done {
                    this.open.connection.moved(bytes);
                }
                done
            }
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
    /// Whether the current line is empty but for a carriage return; false on the first line.
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
