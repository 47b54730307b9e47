//! Connections over TLS.

use std::fs;
use std::net::TcpListener;
use std::os::unix::fs::{MetadataExt, PermissionsExt, chown};

use rcgen::{CertificateParams, IsCa, Issuer, KeyPair};

use crate::history::{begin, empty};
use crate::server::{Server, copier, outcome};

fn authority() -> (String, Issuer<'static, KeyPair>) {
    let mut params = CertificateParams::new(Vec::<String>::new()).unwrap();
    params.is_ca = IsCa::Ca(rcgen::BasicConstraints::Unconstrained);
    let key = KeyPair::generate().unwrap();
    let certificate = params.self_signed(&key).unwrap();
    (certificate.pem(), Issuer::new(params, key))
}

#[test]
fn sslmode_says_what_is_verified() {
    let [(own, issuer), (other, _)] = [authority(), authority()];
    let key = KeyPair::generate().unwrap();
    let certificate = CertificateParams::new(vec!["localhost".to_owned()]).unwrap().signed_by(&key, &issuer).unwrap();
    let port = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap().port();
    let options = ["listen_addresses=127.0.0.1", &format!("port={port}"), "ssl=on"];
    let rule = "hostssl all ada 127.0.0.1/32 scram-sha-256\nhostnossl all ada 127.0.0.1/32 reject";
    let prepare = |data: &std::path::Path| {
        let [chain, secret] = ["server.crt", "server.key"].map(|name| data.join(name));
        fs::write(&chain, certificate.pem()).unwrap();
        fs::write(&secret, key.serialize_pem()).unwrap();
        fs::set_permissions(&secret, fs::Permissions::from_mode(0o600)).unwrap();
        let metadata = fs::metadata(data).unwrap();
        for file in [chain, secret] {
            chown(file, Some(metadata.uid()), Some(metadata.gid())).unwrap();
        }
    };
    let Some(server) = Server::start_with(&options, rule, prepare) else { return };
    let path = |name: &str| server.path().join(name);
    fs::write(path("own.pem"), own).unwrap();
    fs::write(path("other.pem"), other).unwrap();
    let file = path("h.db");
    begin(&empty(&file), "hall", "2026-01-01T00:00:00.000Z");
    server
        .client("fleet")
        .batch_execute("CREATE USER ada PASSWORD 'secret'; CREATE SCHEMA saoms AUTHORIZATION ada")
        .unwrap();
    let folder = server.path().display();
    for (host, options, expected) in [
        ("localhost", "sslmode=disable".to_owned(), "refuses the user `ada`: pg_hba.conf rejects"),
        ("localhost", "sslmode=prefer".to_owned(), "brought: "),
        ("localhost", "sslmode=require".to_owned(), "brought: "),
        ("localhost", "sslmode=require&channel_binding=require".to_owned(), "brought: "),
        ("localhost", format!("sslmode=verify-full&sslrootcert={folder}/own.pem"), "brought: "),
        ("localhost", format!("sslmode=verify-full&sslrootcert={folder}/other.pem"), "invalid peer certificate"),
        ("127.0.0.1", format!("sslmode=verify-full&sslrootcert={folder}/own.pem"), "not valid for name"),
        ("127.0.0.1", format!("sslmode=verify-ca&sslrootcert={folder}/own.pem"), "brought: "),
        ("127.0.0.1", format!("sslmode=verify-ca&sslrootcert={folder}/other.pem"), "invalid peer certificate"),
        ("127.0.0.1", format!("sslmode=require&sslrootcert={folder}/other.pem"), "invalid peer certificate"),
    ] {
        let url = format!("postgres://ada@{host}:{port}/fleet?{options}");
        let output = copier().arg(&file).args(["--to", &url]).env("PGPASSWORD", "secret").output().unwrap();
        let (code, told) = outcome(&output);
        assert!(told.contains(expected), "{url}: {told}");
        assert_eq!(code, if expected == "brought: " { 0 } else { 2 }, "{url}: {told}");
    }
}
