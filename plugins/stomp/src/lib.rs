//! The transport over STOMP 1.2: `stomp://host:port`, and with TLS `stomp+ssl://host:port`. [`Stomp`] is all that it
//! consists of beside what transports share.

use saoms_transport::Session;
use saoms_transport::stomp::Stomp;

saoms_transport::transport!(Session<Stomp>, saoms_transport_stomp, schemes: r#"["stomp","stomp+ssl"]"#);
