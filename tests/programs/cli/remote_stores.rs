//! Elevation in the stores of Google and Azure: the answers of the file on disk.

use std::io::{Read, Write};
use std::net::TcpListener;
use std::thread;

use crate::cli::remote_servers::TestServer;
use crate::cli::{program, project, ran};

const POSITION: [&str; 4] = ["--at", "-84.21,36.28", "--crs", "EPSG:4326"];

/// Checks that the heights of a file in a store are those of the file on disk.
#[track_caller]
fn assert_same_height(server: &TestServer, cache: &str, address: &str) {
    let height =
        |file: &str| [&["height", file], &POSITION[..]].concat().into_iter().map(str::to_owned).collect();
    let words: Vec<String> = height(address);
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    let (there, bytes) = server.fetched(cache, &words);
    let dem = project("assets/jacksboro/dem.tif");
    let here = ran(program(server.scratch.folder(), &height(&dem)).output().expect("the program starts"));
    assert_eq!(there, here.ok(), "{address}");
    assert!(bytes > 0, "{address}");
}

#[test]
fn a_file_in_azure_gives_the_bits_of_the_file_on_disk() {
    let Some(mut server) = TestServer::azure() else { return };
    server.put(project("assets/jacksboro/dem.tif").as_ref(), "dem/terrain.tif");
    assert_same_height(&server, "emulator", "az://terrain/dem/terrain.tif");

    // By an endpoint, and the account with its key, as a store of one's own has them.
    let endpoint = format!("http://{}/devstoreaccount1", server.host);
    let key = "Eby8vdM02xNOcqFlqUwJPLlmEtlCDXJ1OUzFT50uSRZ6IFsuFq2UVErCz4I6tq/K1SZFPTOtr/KBHBeksoGMGw==";
    server.variables = vec![
        ("AZURE_STORAGE_ENDPOINT", endpoint.into()),
        ("AZURE_STORAGE_ACCOUNT_NAME", "devstoreaccount1".into()),
        ("AZURE_STORAGE_ACCOUNT_KEY", key.into()),
        ("AZURE_ALLOW_HTTP", "true".into()),
    ];
    assert_same_height(&server, "endpoint", "az://terrain/dem/terrain.tif");

    // The container is not public.
    server.variables.retain(|(name, _)| *name != "AZURE_STORAGE_ACCOUNT_KEY");
    let words = [&["height", "az://terrain/dem/terrain.tif"], &POSITION[..]].concat();
    let refused = server.run("endpoint", &words).failed(1);
    assert!(refused.contains("az://terrain/dem/terrain.tif: "), "{refused}");
}

#[test]
fn a_file_in_google_cloud_storage_gives_the_bits_of_the_file_on_disk() {
    let Some(mut server) = TestServer::google() else { return };
    server.put(project("assets/jacksboro/dem.tif").as_ref(), "dem/terrain.tif");
    assert_same_height(&server, "unsigned", "gs://open/dem/terrain.tif");

    // An account of a service that names its server and needs no token, as emulators have it.
    let account = format!(
        r#"{{"private_key": "none", "private_key_id": "none", "client_email": "none", "disable_oauth": true,
            "gcs_base_url": "http://{}"}}"#,
        server.host
    );
    let account = server.scratch.write("account.json", account);
    server.variables = vec![("GOOGLE_SERVICE_ACCOUNT", account.into()), ("GOOGLE_ALLOW_HTTP", "true".into())];
    assert_same_height(&server, "account", "gs://open/dem/terrain.tif");
}

#[test]
fn a_token_that_is_stated_is_sent_to_google_cloud_storage() {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let host = listener.local_addr().expect("bound").to_string();
    let server = thread::spawn(move || {
        let (mut stream, _) = listener.accept().expect("a connection");
        let mut head = [0; 4096];
        let count = stream.read(&mut head).expect("a request");
        let _ = stream.write_all(b"HTTP/1.1 404 Not Found\r\ncontent-length: 0\r\nconnection: close\r\n\r\n");
        String::from_utf8_lossy(&head[..count]).to_ascii_lowercase()
    });
    let words = ["height", "gs://terrain/dem.tif", "--at", "1,2", "--allow-remote", &host];
    let mut command = program(project("assets").as_ref(), &words);
    command
        .env("GOOGLE_BASE_URL", format!("http://{host}"))
        .env("GOOGLE_ALLOW_HTTP", "true")
        .env("GOOGLE_BEARER_TOKEN", "testing");
    let missing = ran(command.output().expect("the program starts")).failed(1);
    assert!(missing.contains("gs://terrain/dem.tif: there is no such file"), "{missing}");
    let head = server.join().expect("it answered");
    assert!(head.contains("\r\nauthorization: bearer testing\r\n"), "{head}");
}
