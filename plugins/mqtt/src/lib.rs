//! The transport over MQTT 5: `mqtt://host:port`, and with TLS `mqtts://host:port`. [`Mqtt`] is all that it consists of
//! beside what transports share.

use saoms_transport::Session;
use saoms_transport::mqtt::Mqtt;

saoms_transport::transport!(Session<Mqtt>, saoms_transport_mqtt, schemes: r#"["mqtt","mqtts"]"#);
