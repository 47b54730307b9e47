//! TLS: a look at its files before anything starts, what a program connects with, and words for what goes wrong.

use std::fs;
use std::sync::Arc;

use rustls::crypto::ring::default_provider;
use rustls::crypto::ring::sign::any_supported_type;
use rustls::pki_types::{CertificateDer, PrivateKeyDer, ServerName};
use rustls::sign::CertifiedKey;
use rustls::{
    AlertDescription, CertificateError, ClientConfig, ClientConnection, Error, InconsistentKeys, InvalidMessage,
    RootCertStore,
};
use serde::Deserialize;
use x509_parser::certificate::X509Certificate;
use x509_parser::prelude::FromDer as _;
use x509_parser::time::ASN1Time;

use crate::Failure;

/// What is wrong with a setting.
pub type Fault = (&'static str, String);

/// Paths of files.
#[derive(Debug, Default, Deserialize)]
pub struct Files {
    /// Certificates of those who may vouch for others.
    pub ca: Option<String>,
    /// The certificate of this program.
    pub certificate: Option<String>,
    /// The key of this certificate.
    pub key: Option<String>,
}

/// What is said of a certificate of the broker for which nobody vouches.
pub const UNKNOWN_ISSUER: &str = "nobody in `tlsCa` vouches for the certificate of the broker";
/// What is said of a certificate of the broker that is not valid now.
pub const NOT_VALID: &str = "the certificate of the broker is not valid at this time: renew it, or set the clock";
/// What is said where the broker asks for a certificate.
pub const ASKS: &str = "the broker asks for a certificate: give `tlsCertificate` and `tlsKey`";
/// What is said where the broker does not accept the certificate of the program.
pub const NOT_ACCEPTED: &str =
    "the broker does not accept the certificate in `tlsCertificate`: its `tlsCa` does not vouch for it";

/// What is said of a certificate of the broker that is for another machine.
pub fn not_for(host: &str) -> String {
    format!("the certificate of the broker is not for `{host}`: name it as the certificate does")
}

/// What is wrong with files for TLS; `instead` is how a network with TLS is named.
pub fn judge(files: &Files, is_tls: bool, instead: &str) -> Vec<Fault> {
    let mut faults = Vec::new();
    let Files { ca, certificate, key } = files;
    if !is_tls {
        if [ca, certificate, key].into_iter().any(Option::is_some) {
            faults.push(("url", format!("files for TLS are given for a network without it: write `{instead}`")));
        }
        return faults;
    }
    let mut keep = |setting, read: Option<Result<_, String>>| match read? {
        Ok(found) => Some(found),
        Err(text) => {
            faults.push((setting, text));
            None
        }
    };
    let _ = keep("ca", ca.as_ref().map(|path| authorities(path)));
    let own = keep("certificate", certificate.as_ref().map(|path| certificates(path)));
    let own_key = match key.as_ref().map(|path| private_key(path)) {
        Some(Err(text)) => {
            faults.push(("key", text));
            None
        }
        read => read.and_then(Result::ok),
    };
    if let (Some(own), Some(own_key), Some(certificate), Some(key)) = (own, own_key, certificate, key) {
        match any_supported_type(&own_key).map(|signing| CertifiedKey::new(own, signing).keys_match()) {
            Ok(Err(Error::InconsistentKeys(InconsistentKeys::KeyMismatch))) => {
                faults.push(("key", format!("the key in `{key}` is not that of the certificate in `{certificate}`")));
            }
            Ok(_) => {}
            Err(error) => faults.push(("key", format!("the key in `{key}` cannot be used: {error}"))),
        }
    }
    faults
}

/// A connection of a program to a host, for whose certificate somebody in the file `ca` has to vouch.
pub(crate) fn connection(files: &Files, host: &str) -> Result<ClientConnection, Failure> {
    let mut roots = RootCertStore::empty();
    if let Some(path) = &files.ca {
        let (added, _) = roots.add_parsable_certificates(authorities(path).map_err(Failure::failed)?);
        if added == 0 {
            return Err(Failure::failed(format!("nobody whose certificate is in `{path}` can vouch for others")));
        }
    }
    let config = ClientConfig::builder_with_provider(Arc::new(default_provider()))
        .with_safe_default_protocol_versions()
        .map_err(Failure::failed)?
        .with_root_certificates(roots);
    let config = match (&files.certificate, &files.key) {
        (Some(certificate), Some(key)) => {
            let own = certificates(certificate).map_err(Failure::failed)?;
            config.with_client_auth_cert(own, private_key(key).map_err(Failure::failed)?).map_err(Failure::failed)?
        }
        _ => config.with_no_client_auth(),
    };
    let name = ServerName::try_from(host.to_owned()).map_err(Failure::failed)?;
    ClientConnection::new(Arc::new(config), name).map_err(Failure::failed)
}

/// What an error of TLS means, for people; `None` where that is not known. `without` is how a network without TLS is
/// named.
pub(crate) fn words(error: &Error, host: &str, without: &str) -> Option<String> {
    Some(match error {
        Error::InvalidCertificate(CertificateError::UnknownIssuer | CertificateError::BadSignature) => {
            UNKNOWN_ISSUER.to_owned()
        }
        Error::InvalidCertificate(
            CertificateError::NotValidForName | CertificateError::NotValidForNameContext { .. },
        ) => not_for(host),
        Error::InvalidCertificate(
            CertificateError::Expired
            | CertificateError::ExpiredContext { .. }
            | CertificateError::NotValidYet
            | CertificateError::NotValidYetContext { .. },
        ) => NOT_VALID.to_owned(),
        Error::AlertReceived(AlertDescription::CertificateRequired) => ASKS.to_owned(),
        Error::AlertReceived(
            AlertDescription::UnknownCA
            | AlertDescription::BadCertificate
            | AlertDescription::CertificateUnknown
            | AlertDescription::DecryptError
            | AlertDescription::AccessDenied,
        ) => NOT_ACCEPTED.to_owned(),
        Error::InvalidMessage(InvalidMessage::InvalidContentType) => {
            format!("who listens there does not speak TLS: write `{without}`, or name the port of the broker that does")
        }
        _ => return None,
    })
}

/// The certificates of a file, which are all valid now.
fn certificates(path: &str) -> Result<Vec<CertificateDer<'static>>, String> {
    let all = parts(path)?;
    all.iter().try_for_each(|one| judge_certificate(path, one))?;
    Ok(all)
}

/// Those of a file that are valid now. It may have others beside them: who collects for years those who may vouch for
/// others has some that have expired.
fn authorities(path: &str) -> Result<Vec<CertificateDer<'static>>, String> {
    let mut why = None;
    let mut all = parts(path)?;
    all.retain(|one| match judge_certificate(path, one) {
        Ok(()) => true,
        Err(text) => {
            why.get_or_insert(text);
            false
        }
    });
    match why {
        Some(why) if all.is_empty() => Err(why),
        _ => Ok(all),
    }
}

/// The certificates of a file, at least one.
fn parts(path: &str) -> Result<Vec<CertificateDer<'static>>, String> {
    let text = read(path)?;
    let all: Vec<CertificateDer<'static>> = rustls_pemfile::certs(&mut text.as_slice())
        .collect::<Result<_, _>>()
        .map_err(|error| format!("the certificate in `{path}` cannot be read: {error}"))?;
    if all.is_empty() {
        return Err(format!("there is no certificate in `{path}`: expected `-----BEGIN CERTIFICATE-----`"));
    }
    Ok(all)
}

/// Looks whether a certificate of a file is valid now.
fn judge_certificate(path: &str, one: &CertificateDer<'_>) -> Result<(), String> {
    let now = ASN1Time::now();
    let (_, one) = X509Certificate::from_der(one)
        .map_err(|error| format!("the certificate in `{path}` cannot be read: {error}"))?;
    let validity = one.validity();
    if validity.not_after < now {
        return Err(format!("the certificate in `{path}` has expired, on {}", validity.not_after));
    }
    if validity.not_before > now {
        return Err(format!("the certificate in `{path}` is not valid yet, but from {} on", validity.not_before));
    }
    Ok(())
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

#[cfg(test)]
mod tests {
    use rcgen::{BasicConstraints, CertificateParams, IsCa, KeyPair, date_time_ymd};

    use super::*;

    /// The certificate of somebody who may vouch for others until this year.
    fn authority(year: i32) -> String {
        let mut params = CertificateParams::new(Vec::new()).unwrap();
        params.is_ca = IsCa::Ca(BasicConstraints::Unconstrained);
        params.not_before = date_time_ymd(2000, 1, 1);
        params.not_after = date_time_ymd(year, 1, 1);
        params.self_signed(&KeyPair::generate().unwrap()).unwrap().pem()
    }

    #[test]
    fn who_may_not_vouch_any_more_is_passed_over_beside_others() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("ca.pem").to_str().unwrap().to_owned();
        let files = Files { ca: Some(path.clone()), ..Files::default() };
        let (old, new) = (authority(2020), authority(4000));
        fs::write(&path, format!("{old}{new}{old}")).unwrap();
        assert_eq!((judge(&files, true, ""), authorities(&path).unwrap().len()), (Vec::new(), 1));
        assert!(connection(&files, "broker").is_ok());
        // In a chain of its own, each has to be valid.
        assert!(certificates(&path).is_err());
        fs::write(&path, format!("{old}{old}")).unwrap();
        let faults = judge(&files, true, "");
        assert!(faults.len() == 1 && faults[0].0 == "ca" && faults[0].1.contains("has expired, on"), "{faults:?}");
        assert!(connection(&files, "broker").is_err());
    }
}
