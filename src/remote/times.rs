//! Timeouts for servers: to connect, between the parts of a reply, and for all tries of a request together.
//!
//! The last bounds what the others leave: a server that sends a byte now and then is never silent, and its reply never ends.

use std::time::Duration;

/// The longest times of a request.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct RemoteTimes {
    /// To connect, encryption included.
    pub connect: Duration,
    /// Between two parts of a reply, and before the first.
    pub silence: Duration,
    /// From the first try of a request to the start of the last.
    pub retry: Duration,
    /// For the bytes of a request with all its tries.
    pub request: Duration,
}

impl Default for RemoteTimes {
    /// Distant servers answer in half a second, and 30 seconds are enough for the largest request on a line of 2 Mbit/s.
    fn default() -> Self {
        Self {
            connect: Duration::from_secs(5),
            silence: Duration::from_secs(10),
            retry: Duration::from_secs(15),
            request: Duration::from_secs(30),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::io::{Read, Seek, SeekFrom, Write};
    use std::net::{TcpListener, TcpStream};
    use std::thread;

    use super::*;
    use crate::access::RemoteAccess;
    use crate::address::{AllowedHost, RemoteAddress};
    use crate::error::RemoteError;
    use crate::file::RemoteFile;
    use crate::store::StoredFile;

    const HEAD: &str = "HTTP/1.1 206 Partial\r\ncontent-range: bytes 0-8191/50000\r\ncontent-length: 8192\r\netag: \"a\"\r\n\r\n";

    /// Times that a test can wait for; those that are not tested are so long that they are not met.
    fn silent_after(silence_ms: u64) -> RemoteTimes {
        RemoteTimes {
            connect: Duration::from_secs(20),
            silence: Duration::from_millis(silence_ms),
            retry: Duration::ZERO,
            request: Duration::from_secs(3600),
        }
    }

    /// The host of a server that hands each connection, whose request it has read, to `answer` on a thread of its own, and never
    /// closes one: a client that waits for its end waits for ever.
    fn serve(answer: fn(&mut TcpStream)) -> String {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        let host = listener.local_addr().expect("bound").to_string();
        thread::spawn(move || {
            for stream in listener.incoming() {
                let Ok(mut stream) = stream else { return };
                thread::spawn(move || {
                    let _ = stream.read(&mut [0; 4096]);
                    answer(&mut stream);
                    loop {
                        thread::park();
                    }
                });
            }
        });
        host
    }

    fn open(scheme: &str, host: &str, times: RemoteTimes) -> Result<RemoteFile, RemoteError> {
        let address = RemoteAddress::parse(&format!("{scheme}://{host}/dem.tif")).expect("an address")?;
        let hosts = vec![AllowedHost::parse(host).expect("a host")];
        let file = StoredFile::at(&address, &RemoteAccess { hosts, blocks: None }, times)?;
        RemoteFile::open(file, &address.to_string(), None)
    }

    #[track_caller]
    fn assert_times_out(host: &str, times: RemoteTimes, expected: Duration) {
        let error = open("http", host, times).map(drop).expect_err("the server does not answer");
        assert_eq!(error, RemoteError::Timeout(expected));
    }

    #[test]
    fn a_server_that_never_answers_is_an_error() {
        let host = serve(|_| {});
        assert_times_out(&host, silent_after(50), Duration::from_millis(50));
    }

    #[test]
    fn a_reply_that_stops_in_its_middle_is_an_error() {
        let host = serve(|stream| {
            let _ = stream.write_all(HEAD.as_bytes()).and_then(|()| stream.write_all(&[7; 100]));
        });
        assert_times_out(&host, silent_after(50), Duration::from_millis(50));
        let host = serve(|stream| drop(stream.write_all(&HEAD.as_bytes()[..30])));
        assert_times_out(&host, silent_after(50), Duration::from_millis(50));
    }

    #[test]
    fn a_reply_that_trickles_is_an_error_though_never_silent() {
        let host = serve(|stream| {
            let _ = stream.write_all(HEAD.as_bytes());
            while stream.write_all(&[7]).is_ok() {
                thread::sleep(Duration::from_millis(20));
            }
        });
        let times = RemoteTimes { request: Duration::from_millis(300), ..silent_after(3_600_000) };
        assert_times_out(&host, times, times.request);
    }

    #[test]
    fn a_server_that_falls_silent_later_fails_the_read() {
        let host = serve(|stream| {
            let _ = stream.write_all(HEAD.as_bytes()).and_then(|()| stream.write_all(&[7; 8192]));
        });
        let mut file = open("http", &host, silent_after(500)).expect("it answers once");
        let read = file.seek(SeekFrom::Start(20_000)).and_then(|_| file.read(&mut [0; 10]));
        let error = read.expect_err("it is silent by now").to_string();
        assert_eq!(error, "the server did not answer within 0.5 s");
    }

    #[test]
    fn a_server_that_does_not_begin_to_encrypt_is_an_error() {
        let host = serve(|_| {});
        let times = RemoteTimes { connect: Duration::from_millis(50), ..silent_after(3_600_000) };
        let error = open("https", &host, times).map(drop).expect_err("it is no TLS server");
        assert_eq!(error, RemoteError::Timeout(times.connect));
    }

    #[test]
    fn a_silent_server_is_an_error_within_the_30_seconds_of_the_readme() {
        let times = RemoteTimes::default();
        assert_eq!(times.request, Duration::from_secs(30));
        // The last try of a silent server ends before that, so that its error says what was waited for.
        assert!(times.retry + times.silence < times.request && times.connect < times.silence);
    }
}
