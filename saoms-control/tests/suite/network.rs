//! The server on the network: who may ask it.

use std::fs;
use std::io::{Read, Write};
use std::net::TcpStream;

use saoms_control::{Client, NetworkError, NetworkListener, Token, TokenFile, Tokens};

use super::served;

/// The answer to a request with these headers, to an address and port.
pub(super) fn answer(address: &str, head: &str) -> String {
    exchange(address, &format!("{head}\r\n\r\n"))
}

/// The answer to this text.
pub(super) fn exchange(address: &str, request: &str) -> String {
    let mut stream = TcpStream::connect(address).unwrap();
    stream.write_all(request.as_bytes()).unwrap();
    let mut answer = String::new();
    stream.read_to_string(&mut answer).unwrap();
    answer
}

#[test]
fn the_token_opens_the_same_routes_as_the_socket() {
    let served = served();
    assert_eq!(served.of_network.description().unwrap(), served.client.description().unwrap());
    assert_eq!(served.of_network.request("POST", "/v1/events", "right").unwrap().json().unwrap()["events"], 2);
    let refused = served.of_network.request("POST", "/v1/events", "wrong").unwrap_err().to_string();
    assert_eq!(refused, "no \u{1b}[2J such event");
    let wrong = served.token.with_file_name("wrong");
    let wrong = TokenFile::create(&wrong).unwrap();
    let wrong = Client::of_network(&served.of_network.place(), Token::read(wrong.path()).unwrap()).unwrap();
    let refused = wrong.description().unwrap_err().to_string();
    assert!(refused.contains("the token is missing or wrong"), "{refused}");
}

#[test]
fn a_request_needs_the_token_and_comes_from_no_other_site() {
    let served = served();
    let token = fs::read_to_string(&served.token).unwrap();
    let (address, token) = (&*served.address, token.trim());
    let allowed = format!("Authorization: Bearer {token}");
    let status = |target: &str, headers: &[&str]| {
        let head = format!("GET {target} HTTP/1.0\r\n{}", headers.join("\r\n"));
        let answer = answer(address, &head);
        assert!(!answer.contains(token));
        assert!(answer.to_lowercase().contains("cache-control: no-store"), "{answer}");
        assert!(!answer.to_lowercase().contains("access-control"), "{answer}");
        answer.split(' ').nth(1).unwrap().to_owned()
    };
    let own = format!("Host: {address}");
    let (same, name) = (format!("Origin: http://{address}"), "Host: localhost");
    assert_eq!(status("/v1/fleet", &[&own, &allowed]), "200");
    assert_eq!(status("/v1/fleet", &[name, &allowed]), "200");
    assert_eq!(status("/v1/fleet", &[&own, &same, &allowed]), "200");
    assert_eq!(status(&format!("http://{address}/v1/fleet"), &[&own, &allowed]), "200");
    // Without the token, or with more than one.
    assert_eq!(status("/v1/fleet", &[&own]), "401");
    assert_eq!(status("/nothing", &[&own]), "401");
    assert_eq!(status("/v1/fleet", &[&own, "Authorization: Bearer"]), "401");
    assert_eq!(status("/v1/fleet", &[&own, "Authorization: Bearer 00000000000000000000000000000000"]), "401");
    assert_eq!(status("/v1/fleet", &[&own, &format!("Authorization: Basic {token}")]), "401");
    assert_eq!(status("/v1/fleet", &[&own, &allowed, &allowed]), "401");
    assert_eq!(status(&format!("/v1/fleet?token={token}"), &[&own]), "401");
    // From pages of other sites.
    assert_eq!(status("/v1/fleet", &[&allowed]), "403");
    assert_eq!(status("/v1/fleet", &["Host: evil.example", &allowed]), "403");
    assert_eq!(status("/v1/fleet", &[&own, name, &allowed]), "403");
    assert_eq!(status("http://evil.example/v1/fleet", &[&own, &allowed]), "403");
    for origin in ["null", "http://evil.example", "http://localhost", "http://127.0.0.1:1", ""] {
        assert_eq!(status("/v1/fleet", &[&own, &format!("Origin: {origin}"), &allowed]), "403", "{origin}");
    }
    assert_eq!(status("/v1/fleet", &[&own, &same, &same, &allowed]), "403");
}

#[test]
fn an_address_that_others_reach_has_to_be_allowed() {
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str| TokenFile::create(&folder.path().join(name)).unwrap();
    let token = || Tokens { control: file("token"), view: file("view-token") };
    for address in ["0.0.0.0:0", "[::]:0", "192.0.2.1:80"] {
        let refused = NetworkListener::bind(address, false, token());
        assert!(matches!(refused, Err(NetworkError::NotLoopback(_))), "{address}");
    }
    let allowed = NetworkListener::bind("0.0.0.0:0", true, token()).unwrap();
    assert!(allowed.url().starts_with("http://0.0.0.0:"));
    for address in ["", "127.0.0.1", "127.0.0.1:x", "127.0.0.1:70000", ":"] {
        let refused = NetworkListener::bind(address, true, token());
        assert!(matches!(refused, Err(NetworkError::Malformed(_))), "{address}");
    }
    let port = allowed.url().rsplit_once(':').unwrap().1.to_owned();
    let taken = NetworkListener::bind(&format!("0.0.0.0:{port}"), true, token());
    assert!(matches!(taken, Err(NetworkError::System(_))));
}
