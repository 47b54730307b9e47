//! A look at the files for TLS before Zenoh reads them.

use saoms_transport::tls::{self, Fault};

use super::settings::Settings;

/// What is wrong with the files for TLS.
pub(super) fn judge(settings: &Settings) -> Vec<Fault> {
    let mut faults = Vec::new();
    let files = &settings.tls;
    if settings.listen && settings.is_tls() && files.certificate.is_none() {
        faults.push(("certificate", "a broker with TLS needs a certificate and its key".to_owned()));
    }
    if settings.is_tls() && settings.of_peers().is_some() && (files.ca.is_none() || files.certificate.is_none()) {
        let text = "peers with TLS recognise each other by certificates: give `tlsCa`, `tlsCertificate` and `tlsKey`";
        faults.push(("url", text.to_owned()));
    }
    faults.extend(tls::judge(files, settings.is_tls(), "tls://host:port"));
    faults
}
