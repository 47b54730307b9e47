//! A look at the files for TLS before Zenoh reads them.

use std::fs;

use rustls::crypto::ring::sign::any_supported_type;
use rustls::pki_types::{CertificateDer, PrivateKeyDer};
use rustls::sign::CertifiedKey;
use x509_parser::certificate::X509Certificate;
use x509_parser::prelude::FromDer as _;
use x509_parser::time::ASN1Time;

use super::settings::{Settings, Tls};

/// What is wrong with a setting.
pub(super) type Fault = (&'static str, String);

/// What is wrong with the files for TLS.
pub(super) fn judge(settings: &Settings) -> Vec<Fault> {
    let mut faults = Vec::new();
    let Tls { ca, certificate, key } = &settings.tls;
    if !settings.is_tls() {
        if [ca, certificate, key].into_iter().any(Option::is_some) {
            faults
                .push(("url", "files for TLS are given for a network without it: write `tls://host:port`".to_owned()));
        }
        return faults;
    }
    if settings.listen && certificate.is_none() {
        faults.push(("certificate", "a broker with TLS needs a certificate and its key".to_owned()));
    }
    if settings.of_peers().is_some() && (ca.is_none() || certificate.is_none()) {
        let text = "peers with TLS recognise each other by certificates: give `tlsCa`, `tlsCertificate` and `tlsKey`";
        faults.push(("url", text.to_owned()));
    }
    let mut read = |setting, path: &Option<String>| match certificates(path.as_ref()?) {
        Ok(found) => Some(found),
        Err(text) => {
            faults.push((setting, text));
            None
        }
    };
    let _ = read("ca", ca);
    let own = read("certificate", certificate);
    let own_key = match key.as_ref().map(|path| private_key(path)) {
        Some(Err(text)) => {
            faults.push(("key", text));
            None
        }
        read => read.and_then(Result::ok),
    };
    if let (Some(own), Some(own_key), Some(certificate), Some(key)) = (own, own_key, certificate, key) {
        match any_supported_type(&own_key).map(|signing| CertifiedKey::new(own, signing).keys_match()) {
            Ok(Err(rustls::Error::InconsistentKeys(rustls::InconsistentKeys::KeyMismatch))) => {
                faults.push(("key", format!("the key in `{key}` is not that of the certificate in `{certificate}`")));
            }
            Ok(_) => {}
            Err(error) => faults.push(("key", format!("the key in `{key}` cannot be used: {error}"))),
        }
    }
    faults
}

/// The certificates of a file, which are valid now.
fn certificates(path: &str) -> Result<Vec<CertificateDer<'static>>, String> {
    let text = read(path)?;
    let all: Vec<CertificateDer<'static>> = rustls_pemfile::certs(&mut text.as_slice())
        .collect::<Result<_, _>>()
        .map_err(|error| format!("the certificate in `{path}` cannot be read: {error}"))?;
    if all.is_empty() {
        return Err(format!("there is no certificate in `{path}`: expected `-----BEGIN CERTIFICATE-----`"));
    }
    let now = ASN1Time::now();
    for one in &all {
        let (_, one) = X509Certificate::from_der(one)
            .map_err(|error| format!("the certificate in `{path}` cannot be read: {error}"))?;
        let validity = one.validity();
        if validity.not_after < now {
            return Err(format!("the certificate in `{path}` has expired, on {}", validity.not_after));
        }
        if validity.not_before > now {
            return Err(format!("the certificate in `{path}` is not valid yet, but from {} on", validity.not_before));
        }
    }
    Ok(all)
}

fn private_key(path: &str) -> Result<PrivateKeyDer<'static>, String> {
    match rustls_pemfile::private_key(&mut read(path)?.as_slice()) {
        Ok(Some(key)) => Ok(key),
        Ok(None) => Err(format!("there is no private key in `{path}`: expected `-----BEGIN PRIVATE KEY-----`")),
        Err(error) => Err(format!("the key in `{path}` cannot be read: {error}")),
    }
}

fn read(path: &str) -> Result<Vec<u8>, String> {
    fs::read(path).map_err(|error| format!("`{path}` cannot be read: {error}"))
}
