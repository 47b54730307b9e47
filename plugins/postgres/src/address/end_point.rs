//! What binds a password to the certificate of a server: `tls-server-end-point` of RFC 5929, section 4.1.

use sha2::{Digest, Sha256, Sha384, Sha512};

/// The object identifiers of RSA (PKCS #1) and of ECDSA, without their last numbers, which say the hash.
const RSA: &[u8] = &[0x2a, 0x86, 0x48, 0x86, 0xf7, 0x0d, 0x01, 0x01];
const ECDSA_SHA1: &[u8] = &[0x2a, 0x86, 0x48, 0xce, 0x3d, 0x04];
const ECDSA: &[u8] = &[0x2a, 0x86, 0x48, 0xce, 0x3d, 0x04, 0x03];

/// The hash of a certificate in DER, by the function with which it is signed. `None` where that names none, as Ed25519.
pub(super) fn end_point(certificate: &[u8]) -> Option<Vec<u8>> {
    let (whole, _) = element(certificate)?;
    let (_signed, rest) = element(whole)?;
    let (algorithm, _) = element(rest)?;
    let (identifier, _) = element(algorithm)?;
    let (last, family) = identifier.split_last()?;
    match (family, last) {
        // MD5 and SHA-1 become SHA-256.
        (RSA, 4 | 5 | 11) | (ECDSA_SHA1, 1) | (ECDSA, 2) => Some(Sha256::digest(certificate).to_vec()),
        (RSA, 12) | (ECDSA, 3) => Some(Sha384::digest(certificate).to_vec()),
        (RSA, 13) | (ECDSA, 4) => Some(Sha512::digest(certificate).to_vec()),
        _ => None,
    }
}

/// The content of the first element in DER, and what follows it.
fn element(der: &[u8]) -> Option<(&[u8], &[u8])> {
    let [_tag, first, rest @ ..] = der else { return None };
    let (length, rest) = match first {
        0..=0x7f => (usize::from(*first), rest),
        0x81..=0x84 => {
            let (bytes, rest) = rest.split_at_checked(usize::from(first & 0x7f))?;
            (bytes.iter().fold(0, |length, byte| length << 8 | usize::from(*byte)), rest)
        }
        _ => return None,
    };
    rest.split_at_checked(length)
}

#[cfg(test)]
mod tests {
    use rcgen::{
        CertificateParams, KeyPair, PKCS_ECDSA_P256_SHA256, PKCS_ECDSA_P384_SHA384, PKCS_ED25519, SignatureAlgorithm,
    };

    use super::*;

    #[test]
    fn the_hash_is_that_of_the_signature() {
        let signed = |by: &'static SignatureAlgorithm| {
            let key = KeyPair::generate_for(by).unwrap();
            CertificateParams::new(vec!["server".to_owned()]).unwrap().self_signed(&key).unwrap().der().to_vec()
        };
        let certificate = signed(&PKCS_ECDSA_P256_SHA256);
        assert_eq!(end_point(&certificate), Some(Sha256::digest(&certificate).to_vec()));
        let certificate = signed(&PKCS_ECDSA_P384_SHA384);
        assert_eq!(end_point(&certificate), Some(Sha384::digest(&certificate).to_vec()));
        assert_eq!(end_point(&signed(&PKCS_ED25519)), None);
        for end in 0..certificate.len() {
            // What is cut off is no certificate, and nothing panics.
            assert_eq!(end_point(&certificate[..end]), None, "{end}");
        }
        assert_eq!(end_point(&[0x30, 0x84, 0xff, 0xff, 0xff, 0xff, 0x30]), None);
    }
}
