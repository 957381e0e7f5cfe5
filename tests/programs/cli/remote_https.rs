//! Elevation by `https`, from a server whose certificate is made for the test.

use crate::cli::remote_servers::TestServer;
use crate::cli::{Ran, program, project, ran};

/// An encrypted server of the files in `assets/jacksboro`.
struct EncryptedServer(TestServer);

impl EncryptedServer {
    fn start() -> Option<Self> {
        TestServer::encrypted(&project("assets/jacksboro")).map(Self)
    }

    /// The answer of `height` for the file as `host` has it, where the authorities of a file are trusted.
    fn height(&self, host: &str, authorities: &str) -> Ran {
        let address = format!("https://{host}/dem.tif");
        let arguments =
            ["height", &address, "--at", "-84.21,36.28", "--crs", "EPSG:4326", "--allow-remote", host];
        let mut command = program(self.0.scratch.folder(), &arguments);
        command
            .env("SSL_CERT_FILE", self.0.scratch.at(authorities))
            .env_remove("SSL_CERT_DIR")
            .env("XDG_CACHE_HOME", self.0.scratch.at("cache"));
        ran(command.output().expect("the program starts"))
    }

    /// What is said of a certificate that is refused, after one request: another would be refused too.
    #[track_caller]
    fn refusal(&self, host: &str, authorities: &str) -> String {
        let error = self.height(host, authorities).failed(1);
        assert!(error.contains("note: 1 requests fetched 0 bytes"), "{error}");
        error
    }
}

#[test]
fn an_encrypted_server_gives_the_bits_of_the_file_on_disk() {
    let Some(server) = EncryptedServer::start() else { return };
    let there = server.height(&server.0.host, "authority.pem");
    assert_eq!(there.code, 0, "{there:?}");
    let dem = project("assets/jacksboro/dem.tif");
    let arguments = ["height", &dem, "--at", "-84.21,36.28", "--crs", "EPSG:4326"];
    let here = ran(program(server.0.scratch.folder(), &arguments).output().expect("the program starts"));
    assert_eq!(there.out, here.ok());
}

#[test]
fn a_certificate_that_is_not_trusted_is_refused_at_once() {
    let Some(server) = EncryptedServer::start() else { return };
    let error = server.refusal(&server.0.host, "stranger.pem");
    let said = format!("the certificate of {} is not to be trusted: no authority", server.0.host);
    assert!(error.contains(&said) && error.contains("SSL_CERT_FILE"), "{error}");
    // Of an authority that is trusted, for another name.
    let other = server.0.host.replace("127.0.0.1", "localhost");
    let error = server.refusal(&other, "authority.pem");
    assert!(error.contains(&format!("the certificate of {other} is not to be trusted")), "{error}");
    assert!(error.contains("not valid for name \"localhost\""), "{error}");
}

#[test]
fn without_any_authority_no_connection_is_made() {
    let Some(server) = EncryptedServer::start() else { return };
    let error = server.height(&server.0.host, "none.pem").failed(1);
    assert!(error.contains("no connection can be encrypted") && error.contains("SSL_CERT_FILE"), "{error}");
}
