//! TLS, with the cryptography that networks of fleets use.

use std::fs::File;
use std::io::BufReader;
use std::sync::Arc;

use rustls::client::WebPkiServerVerifier;
use rustls::client::danger::{HandshakeSignatureValid, ServerCertVerified, ServerCertVerifier};
use rustls::crypto::{CryptoProvider, ring, verify_tls12_signature, verify_tls13_signature};
use rustls::pki_types::{CertificateDer, ServerName, UnixTime};
use rustls::{CertificateError, ClientConfig, DigitallySignedStruct, Error, RootCertStore, SignatureScheme};

use super::connector::Connector;

/// Whom a connection trusts.
pub(super) enum Trust<'a> {
    /// Whoever answers: what is read on the way is encrypted, no more.
    Anybody,
    /// Who has a certificate of an authority in this file.
    Authority(&'a str),
    /// The same, if the certificate is that of the host.
    Name(&'a str),
}

/// What connections are encrypted with.
pub(super) struct Tls(Arc<ClientConfig>);

impl Tls {
    pub(super) fn new(trust: Trust<'_>) -> Result<Tls, String> {
        let provider = Arc::new(ring::default_provider());
        let builder = ClientConfig::builder_with_provider(Arc::clone(&provider))
            .with_safe_default_protocol_versions()
            .map_err(|error| format!("TLS cannot be used: {error}"))?;
        let lenient = |chain| Arc::new(Lenient { provider: Arc::clone(&provider), chain });
        let config = match trust {
            Trust::Anybody => builder.dangerous().with_custom_certificate_verifier(lenient(None)),
            Trust::Authority(file) => {
                let roots = Arc::new(roots(file)?);
                let chain = WebPkiServerVerifier::builder_with_provider(roots, Arc::clone(&provider)).build();
                let chain = chain.map_err(|error| format!("`{file}` vouches for nobody: {error}"))?;
                builder.dangerous().with_custom_certificate_verifier(lenient(Some(chain)))
            }
            Trust::Name(file) => builder.with_root_certificates(roots(file)?),
        };
        Ok(Tls(Arc::new(config.with_no_client_auth())))
    }

    pub(super) fn connector(&self) -> Connector {
        Connector(Arc::clone(&self.0))
    }
}

/// The certificates of a file.
fn roots(path: &str) -> Result<RootCertStore, String> {
    let file = File::open(path).map_err(|error| format!("`sslrootcert`: `{path}` cannot be read: {error}"))?;
    let mut store = RootCertStore::empty();
    for certificate in rustls_pemfile::certs(&mut BufReader::new(file)) {
        let certificate = certificate.map_err(|error| format!("`sslrootcert`: `{path}` is damaged: {error}"))?;
        store.add(certificate).map_err(|error| format!("`sslrootcert`: a certificate of `{path}`: {error}"))?;
    }
    if store.is_empty() {
        return Err(format!("`sslrootcert`: `{path}` has no certificate: expected a file of PEM"));
    }
    Ok(store)
}

/// What looks at less than a name: at the authority of a certificate, or at nothing.
#[derive(Debug)]
struct Lenient {
    provider: Arc<CryptoProvider>,
    chain: Option<Arc<WebPkiServerVerifier>>,
}

impl ServerCertVerifier for Lenient {
    fn verify_server_cert(
        &self,
        certificate: &CertificateDer<'_>,
        between: &[CertificateDer<'_>],
        name: &ServerName<'_>,
        response: &[u8],
        now: UnixTime,
    ) -> Result<ServerCertVerified, Error> {
        let Some(chain) = &self.chain else { return Ok(ServerCertVerified::assertion()) };
        match chain.verify_server_cert(certificate, between, name, response, now) {
            // The name is what it looks at last.
            Err(Error::InvalidCertificate(
                CertificateError::NotValidForName | CertificateError::NotValidForNameContext { .. },
            )) => Ok(ServerCertVerified::assertion()),
            other => other,
        }
    }

    fn verify_tls12_signature(
        &self,
        message: &[u8],
        certificate: &CertificateDer<'_>,
        signed: &DigitallySignedStruct,
    ) -> Result<HandshakeSignatureValid, Error> {
        verify_tls12_signature(message, certificate, signed, &self.provider.signature_verification_algorithms)
    }

    fn verify_tls13_signature(
        &self,
        message: &[u8],
        certificate: &CertificateDer<'_>,
        signed: &DigitallySignedStruct,
    ) -> Result<HandshakeSignatureValid, Error> {
        verify_tls13_signature(message, certificate, signed, &self.provider.signature_verification_algorithms)
    }

    fn supported_verify_schemes(&self) -> Vec<SignatureScheme> {
        self.provider.signature_verification_algorithms.supported_schemes()
    }
}
