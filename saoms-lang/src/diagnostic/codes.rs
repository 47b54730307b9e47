//! The table of every kind of diagnostic.
//!
//! A code never changes its meaning and is never used again. `S0` is files and XML, `S1` the SCA vocabulary, `S2` names
//! and wiring, `S3` classes and properties, `S4` tasks, topics and loops. `S5` is what rules of crates of components
//! find (see [`FleetRule`](saoms_api::rule::FleetRule)); each of them declares its own code.

use saoms_api::rule::Severity::{Error, Note, Warning};

pub use saoms_api::rule::Code;

/// What the program has to know of a code beside its meaning.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Nature {
    /// Its errors are judgements on a fleet that could run: their severity can be lowered.
    Judgement,
    /// `saoms expand` leaves the fault in what it writes, so that a severity set for it is written, too.
    OutlivesExpansion,
    /// The wiring report alone finds it.
    OfWiring,
    /// It says that what it is at has no effect.
    WithoutEffect,
    /// It says that a part of the component, or of another element, that it is at is missing.
    AbsentPart,
    /// It says that a composite is in no file.
    AbsentComposite,
    /// It says that a component is nowhere in the fleet.
    AbsentComponent,
    /// It says that another name, or a user of it, is nowhere in the fleet.
    AbsentName,
}

/// The rows of the table: `CONSTANT = id severity name (rule of SCA) [natures]: meaning;`, without those of rule and
/// natures that there are not.
macro_rules! codes {
    ($($constant:ident = $id:literal $severity:ident $name:literal $(($rule:literal))? $([$($nature:ident),*])?
        : $meaning:literal;)*) => {
        $(
            #[doc = $meaning]
            pub static $constant: Code = Code {
                id: $id,
                name: $name,
                meaning: $meaning,
                severity: $severity,
                rule: codes!(@rule $($rule)?),
            };
        )*

        /// Every code, in the order of the table.
        pub static ALL: &[&Code] = &[$(&$constant),*];

        // No rule over fleets may have one of them.
        saoms_registry::inventory::submit! { saoms_registry::ReservedCodes(ALL) }

        /// The natures of each code.
        static NATURES: &[&[Nature]] = &[$(&[$($(Nature::$nature),*)?]),*];
    };
    (@rule) => { None };
    (@rule $rule:literal) => { Some($rule) };
}

codes! {
    // S00: files.
    FILE_NOT_FOUND = "S0001" Error "file-not-found": "There is no file of this name.";
    FILE_IS_DIRECTORY = "S0002" Error "file-is-directory": "A folder was found where a file was expected.";
    FILE_UNREADABLE = "S0003" Error "file-unreadable": "The file exists, but cannot be read.";
    FILE_TOO_LARGE = "S0004" Error "file-too-large": "The file is larger than the size limit.";
    FILE_EMPTY = "S0005" Error "file-empty": "The file is empty, or has only white space.";
    FILE_BINARY = "S0006" Error "file-binary": "The file is not text.";
    FILE_ENCODING = "S0007" Error "file-encoding": "The file is not in UTF-8.";
    TOO_MANY = "S0008" Warning "too-many": "Further diagnostics with this code in this file are counted, but not shown; it has the severity of the diagnostics that it stands for.";
    FILE_OUTSIDE = "S0009" Error "file-outside": "A composite or the description of a contribution names a file or folder outside its folder and its contribution.";
    // S01: XML 1.0 and its namespaces. The first of a file ends the reading of it.
    XML_SYNTAX = "S0101" Error "xml-syntax": "The file is not well-formed XML.";
    XML_TAG_MISMATCH = "S0102" Error "xml-tag-mismatch": "An end tag closes another element than the one that is open.";
    XML_UNCLOSED = "S0103" Error "xml-unclosed": "An element, a comment, a tag or a quoted value has no end.";
    XML_OUTSIDE_ROOT = "S0104" Error "xml-outside-root": "There is text or a second element outside of the root element.";
    XML_ATTRIBUTE = "S0105" Error "xml-attribute": "The syntax of an attribute is wrong.";
    XML_DUPLICATE_ATTRIBUTE = "S0106" Error "xml-duplicate-attribute": "An element has the same attribute twice.";
    XML_NAME = "S0107" Error "xml-name": "The name of an element, an attribute or an instruction is not an XML name.";
    XML_CHARACTER = "S0108" Error "xml-character": "A character that XML does not allow.";
    XML_ENTITY = "S0109" Error "xml-entity": "A reference with `&` is malformed, or is not one to a character or to one of the five predefined entities.";
    XML_DOCTYPE = "S0110" Error "xml-doctype": "A document type declaration is not allowed.";
    XML_DECLARATION = "S0111" Error "xml-declaration": "The XML declaration is malformed or not at the very start.";
    XML_PREFIX = "S0112" Error "xml-prefix": "A prefix is not declared, or its declaration is not allowed.";
    // S10: the vocabulary of SCA.
    ROOT = "S1001" Error "root": "The root element is not a composite.";
    NAMESPACE = "S1002" Error "namespace" ("ASM13001"): "The root element is not in a namespace of SCA.";
    OTHER_VERSION = "S1003" Error "other-version" ("ASM13001"): "An element is of another version of SCA than the composite it is in.";
    UNKNOWN_ELEMENT = "S1004" Error "unknown-element" ("ASM13001"): "SCA or SAOMS has no element with this name.";
    MISPLACED_ELEMENT = "S1005" Error "misplaced-element" ("ASM13001"): "An element is not allowed at this place.";
    REPEATED_ELEMENT = "S1006" Error "repeated-element" ("ASM13001"): "An element that is allowed once is given again.";
    UNKNOWN_ATTRIBUTE = "S1007" Error "unknown-attribute" ("ASM13001") [Judgement]: "An element has an attribute that SCA or SAOMS does not define for it.";
    MISSING_ATTRIBUTE = "S1008" Error "missing-attribute" ("ASM13001"): "A required attribute is missing.";
    MISSING_TARGET_NAMESPACE = "S1009" Error "missing-target-namespace" ("ASM13001") [Judgement, OutlivesExpansion]: "A composite has no target namespace.";
    MISSING_IMPLEMENTATION = "S1010" Error "missing-implementation" ("ASM13001") [AbsentPart]: "A component has no implementation.";
    ATTRIBUTE_VALUE = "S1011" Error "attribute-value" ("ASM13001"): "The value of an attribute has the wrong form.";
    MISPLACED_TEXT = "S1012" Error "misplaced-text" ("ASM13001") [Judgement]: "There is text in an element that contains elements only.";
    NAMESPACE_NEAR = "S1013" Warning "namespace-near": "A namespace is nearly that of SCA or SAOMS, and its elements and attributes are ignored.";
    NEWER_ATTRIBUTE = "S1014" Warning "newer-attribute": "A file of SCA 1.0 has an attribute of SCA 1.1.";
    FOREIGN_ELEMENT = "S1015" Warning "foreign-element": "An element has a name of SCA but another namespace, or is an element of XInclude: it is ignored.";
    HIDDEN_CHARACTER = "S1016" Warning "hidden-character" [OutlivesExpansion]: "A name or a value contains a character that nobody sees, or a letter of another alphabet that looks like a Latin one.";
    // S20: names, composite properties, services, references and wires.
    COMPOSITE_REPEATED = "S2001" Error "composite-repeated" ("ASM60001") [Judgement]: "Two composites in one namespace have the same name.";
    COMPONENT_REPEATED = "S2002" Error "component-repeated" ("ASM50001"): "Two components have the same name.";
    COMPOSITE_PART_REPEATED = "S2003" Error "composite-part-repeated": "A composite has two properties, services or references with the same name.";
    CONTRACT_REPEATED = "S2004" Error "contract-repeated": "A component has two services or references with the same name.";
    UNKNOWN_SERVICE = "S2005" Error "unknown-service" ("ASM50003"): "A component has a service that its class, composite or component type does not have.";
    UNKNOWN_REFERENCE = "S2006" Error "unknown-reference" ("ASM50008"): "A component has a reference that its class, composite or component type does not have.";
    INTERFACE_DIFFERS = "S2007" Error "interface-differs": "The interface of a service or a reference differs from that of the class.";
    MULTIPLICITY_WIDER = "S2008" Error "multiplicity-wider" ("ASM50009"): "The multiplicity of a reference allows a number of targets that the class does not allow.";
    BINDING_NOT_SERVED = "S2009" Warning "binding-not-served": "A service or a reference has a binding that is not supported.";
    URI_MALFORMED = "S2010" Error "uri-malformed": "A target, a source of a wire or a promotion has the wrong form.";
    UNKNOWN_COMPONENT = "S2011" Error "unknown-component" [AbsentComponent]: "A target, a wire or a promotion names a component that does not exist.";
    UNKNOWN_TARGET_SERVICE = "S2012" Error "unknown-target-service" ("ASM60047") [AbsentName]: "A target names a service that the component does not have.";
    UNKNOWN_BINDING = "S2013" Error "unknown-binding" ("ASM60050") [AbsentName]: "A target names a binding that the service does not have.";
    TARGET_AMBIGUOUS = "S2014" Error "target-ambiguous" ("ASM60048"): "A target names a component with several fitting services.";
    WIRE_INTERFACE = "S2015" Error "wire-interface" ("ASM60043"): "A reference is wired to a service with another interface.";
    UNKNOWN_WIRE_SOURCE = "S2016" Error "unknown-wire-source" [AbsentName]: "A wire starts from a reference that the component does not have.";
    TOO_MANY_TARGETS = "S2017" Error "too-many-targets": "A reference has more targets than its multiplicity allows.";
    UNWIRED = "S2018" Error "unwired" [OutlivesExpansion, AbsentName]: "A reference that needs a target has none. A warning in SCA 1.0 files.";
    AUTOWIRE_AMBIGUOUS = "S2019" Error "autowire-ambiguous" ("ASM60025"): "Autowire finds several services for a reference.";
    CALL_CYCLE = "S2020" Error "call-cycle" [Judgement, OutlivesExpansion]: "Components call each other in a cycle.";
    UNKNOWN_PROMOTED = "S2021" Error "unknown-promoted" [AbsentName]: "A composite promotes a service or a reference that does not exist.";
    PROMOTED_UNWIRED = "S2022" Warning "promoted-unwired" [AbsentName]: "A composite that runs by itself promotes a reference, and nothing wires it.";
    SOURCE_MALFORMED = "S2023" Error "source-malformed": "The `source` of a property does not name a value.";
    UNKNOWN_SOURCE = "S2024" Error "unknown-source" [AbsentName]: "The `source` of a property names a composite property that does not exist.";
    COMPOSITE_PROPERTY_MISSING = "S2025" Error "composite-property-missing" ("ASM60034") [AbsentName]: "A composite property needs a value, but has none.";
    UNUSED_PROPERTY = "S2026" Warning "unused-property" [WithoutEffect, AbsentName]: "No component uses a composite property.";
    SETTING_MALFORMED = "S2027" Error "setting-malformed": "An option that sets a composite property has no name or no `=`.";
    SETTING_REPEATED = "S2028" Error "setting-repeated": "A composite property is set twice.";
    UNKNOWN_SETTING = "S2029" Error "unknown-setting" [AbsentName]: "An option sets a composite property that does not exist.";
    INCLUDE_NOT_FOUND = "S2030" Error "include-not-found" ("ASM60042") [AbsentComposite]: "An include names a composite that is not found.";
    COMPOSITE_NOT_FOUND = "S2031" Error "composite-not-found" ("ASM60030") [AbsentComposite]: "A component is implemented by a composite that is not found.";
    COMPOSITE_CIRCLE = "S2032" Error "composite-circle": "A composite includes itself or is implemented by itself, directly or through others.";
    INCLUDED_TWICE = "S2033" Error "included-twice" ("ASM60031") [Judgement]: "A composite is included twice in one composite.";
    INCLUDE_LOCAL = "S2034" Error "include-local" ("ASM60041") [Judgement]: "A composite that is `local` is included in one that is not.";
    FLEET_TOO_LARGE = "S2035" Error "fleet-too-large": "A fleet has too many components, wires or values, because of nested composites, replicas or sources; or the paths of its sources visit too many elements.";
    PROMOTED_MULTIPLICITY = "S2036" Error "promoted-multiplicity" ("ASM60011") [Judgement]: "A composite's reference allows a number of targets that a promoted reference does not allow.";
    PROMOTED_FIXED = "S2037" Error "promoted-fixed" ("ASM50042") [Judgement]: "A composite promotes a reference that takes one target and must not be overridden.";
    WIRED_BY_IMPLEMENTATION = "S2038" Error "wired-by-implementation" ("ASM50013"): "A reference that its implementation wires has a target. A warning in SCA 1.0 files, and if the target comes from outside.";
    TYPE_AND_ELEMENT = "S2039" Error "type-and-element" [Judgement]: "A property has both a type and an element.";
    BINDING_REPEATED = "S2040" Error "binding-repeated" ("ASM90002") [Judgement]: "A service or a reference has two bindings with the same name.";
    SERVICE_BINDING_URI = "S2041" Warning "service-binding-uri" ("ASM90005") [Judgement]: "A service's binding of SCA has a URI.";
    COMPOSITE_VALUE_TYPE = "S2042" Error "composite-value-type" ("ASM50027") [Judgement]: "The value of a composite's property is not of its type.";
    COMPONENT_TYPE_REPEATED = "S2043" Error "component-type-repeated" [Judgement]: "A component type has two services, references or properties with the same name. A warning in SCA 1.0 files.";
    COMPONENT_TYPE_MISSING = "S2044" Error "component-type-missing" ("ASM40001") [Judgement]: "An implementation that does not declare its services has no component type beside it.";
    EXPRESSION = "S2045" Error "expression": "An expression is malformed, or has no value.";
    REPLICAS = "S2046" Error "replicas" [AbsentPart]: "The attributes for the replicas of a component are incomplete or wrong.";
    OVERRIDES = "S2047" Error "overrides": "A table of overrides is malformed, or names replicas that do not exist.";
    SEVERITY = "S2048" Error "severity": "A severity is set for a code that does not exist, to a level that does not exist, or twice.";
    SEVERITY_UNUSED = "S2049" Warning "severity-unused" [AbsentName]: "Setting a severity has no effect: there is no diagnostic with this code, or a composite takes precedence over the option.";
    UNKNOWN_TYPE = "S2050" Error "unknown-type" [Judgement]: "A property has a type that XML Schema does not have.";
    DEPLOYABLE_NOT_FOUND = "S2051" Error "deployable-not-found" [AbsentComposite]: "A contribution lists a deployable composite that it does not have.";
    VALUE_FILE = "S2052" Error "value-file" ("ASM50046"): "A file of values does not have the form that SCA requires.";
    TARGET_IN_TWO_WAYS = "S2054" Error "target-in-two-ways" ("ASM50026"): "A reference has its target in two ways; only one is allowed.";
    EXCHANGE = "S2059" Warning "exchange" [AbsentComposite]: "A contribution exports a namespace in which it has nothing, or imports a namespace that no contribution around it exports.";
    INNER_RUN_SETTING = "S2061" Warning "inner-run-setting" [WithoutEffect]: "An inner composite sets the target of alerts, the effect of a lost terminal or link or the default node; only the outermost composite can set these.";
    RUN_SETTINGS_DIFFER = "S2062" Error "run-settings-differ": "Two outermost composites of one fleet set different targets of alerts, effects of a lost terminal or link or default nodes.";
    NODE_MISSING = "S2063" Error "node-missing": "Some components of a fleet are in a node, and others are in none: no program would run them.";
    UNKNOWN_NODE = "S2064" Error "unknown-node": "The node that is to run does not exist in the fleet.";
    WIRE_BETWEEN_NODES = "S2065" Error "wire-between-nodes" [OutlivesExpansion]: "A reference of a component leads to a component of another node, and cannot be called over.";
    CALL_DEADLINE_UNUSED = "S2066" Warning "call-deadline-unused" [OutlivesExpansion, WithoutEffect]: "A deadline of calls has no effect: no call through the reference waits for another node or a web server, or the service is not offered over the web.";
    WEB_ADDRESS = "S2067" Error "web-address": "The `uri` of a `binding.rest` is not a path for a service, or not an address of HTTP for a reference.";
    WEB_PATH_REPEATED = "S2068" Error "web-path-repeated": "Two services are offered over the web at one path.";
    WEB_SERVICE = "S2069" Error "web-service": "A service cannot be offered over the web.";
    WEB_REFERENCE = "S2070" Error "web-reference" [OutlivesExpansion]: "A reference cannot lead to a web server.";
    WEB_TOKEN = "S2071" Error "web-token": "The token for a web server has no server, has several, or is missing in the environment. What the environment lacks is reported by `saoms run`.";
    WEB_UNSERVED = "S2072" Warning "web-unserved" [OutlivesExpansion]: "Services are offered over the web, but the run has no control server that serves them, or references lead to web servers, which no run in virtual time calls. Reported by `saoms run`.";
    WEB_NOT_ALLOWED = "S2073" Error "web-not-allowed" [OutlivesExpansion]: "References lead to web servers, and the command line does not allow calls of them. Reported by `saoms run`.";
    // S30: classes and properties.
    UNKNOWN_CLASS = "S3001" Error "unknown-class": "No class of this name is registered.";
    IMPLEMENTATION_UNSUPPORTED = "S3002" Error "implementation-unsupported": "A component has a kind of implementation that this program cannot run.";
    UNKNOWN_PROPERTY = "S3004" Error "unknown-property" ("ASM50037") [AbsentPart]: "A component is given a property that its class, composite or component type does not have.";
    PROPERTY_REPEATED = "S3005" Error "property-repeated" ("ASM50031"): "A property is given twice.";
    PROPERTY_MISSING = "S3006" Error "property-missing" ("ASM40011") [AbsentPart]: "A required property has no value.";
    VALUE_TYPE = "S3007" Error "value-type": "A value is of the wrong type.";
    VALUE_RANGE = "S3008" Error "value-range": "A value is out of the range of the property.";
    VALUE_NOT_ALLOWED = "S3009" Error "value-not-allowed": "A value is not among those that the property allows.";
    VALUE_EMPTY = "S3010" Error "value-empty" [AbsentPart]: "A value is empty.";
    MANY_VALUES = "S3011" Error "many-values" ("ASM50032"): "A property that takes one value has several.";
    VALUE_IN_TWO_WAYS = "S3012" Error "value-in-two-ways" ("ASM50033"): "A property is given a value in two ways at once.";
    NOT_UNIQUE = "S3013" Error "not-unique" [Judgement, OutlivesExpansion]: "Two components have the same value for a property that must be unique.";
    CONSTRUCTION = "S3014" Error "construction" [AbsentPart]: "The class of a component rejects its values.";
    LIBRARY = "S3015" Error "library": "The library or the module that an implementation names is not found, cannot be used, or has no such class.";
    ONLY_READ = "S3016" Error "only-read" [OutlivesExpansion]: "A fleet needs the code of a library that was found, but that no option names. A note if the fleet is only checked.";
    EXPRESSION_UNREAD = "S3017" Warning "expression-unread" [OutlivesExpansion]: "A value contains an expression, but the component has no count, or is the source of a property: it is not evaluated.";
    // S40: tasks and topics.
    TASK_ID_SHARED = "S4001" Warning "task-id-shared" [OutlivesExpansion]: "Two tasks have the same ID.";
    TOPIC_RENAME = "S4002" Error "topic-rename": "A `topicRename` is malformed or contradicts itself.";
    RENAME_UNUSED = "S4003" Warning "rename-unused" [OutlivesExpansion, WithoutEffect]: "A component renames a topic that it does not use.";
    USE_JMS = "S4004" Error "use-jms": "A component that publishes or subscribes has `useJMS` set to false.";
    BROKER_URL = "S4005" Error "broker-url": "The address of a message broker is malformed.";
    CREDENTIALS = "S4006" Warning "credentials" [OutlivesExpansion, AbsentPart]: "The account for a message broker is incomplete or not used.";
    DEADLINE = "S4007" Warning "deadline" [OutlivesExpansion]: "A deadline is longer than the period.";
    RESTART_UNUSED = "S4008" Warning "restart-unused" [OutlivesExpansion, WithoutEffect]: "A setting for restarts has no effect: the component is never restarted.";
    TOPIC_MISMATCH = "S4009" Error "topic-mismatch": "Two components use one topic for different messages, or in different ways.";
    TOPIC_UNREAD = "S4010" Note "topic-unread" [OfWiring, AbsentName]: "A component publishes a topic that no component reads. Reported by `saoms check --wiring`.";
    TOPIC_UNWRITTEN = "S4011" Warning "topic-unwritten" [OfWiring, AbsentName]: "A component reads a topic that no component publishes. Reported by `saoms check --wiring`.";
    TOPIC_NEAR = "S4012" Warning "topic-near" [OfWiring, AbsentName]: "A topic has only publishers, only readers or one user, and another topic has a similar name. Reported by `saoms check --wiring`.";
    QUEUE = "S4013" Note "queue" [OfWiring]: "More messages can arrive between two executions of a reader than its queue holds. Reported by `saoms check --wiring`.";
    READER_FASTER = "S4014" Note "reader-faster" [OfWiring]: "A topic is read more often than it is published. Reported by `saoms check --wiring`.";
    TRIGGER = "S4015" Error "trigger": "A `trigger` names a topic whose messages cannot trigger the component.";
    MINIMUM_UNUSED = "S4016" Warning "minimum-unused" [OutlivesExpansion, WithoutEffect]: "A `minimum` has no effect: no topic triggers the component.";
    EVENT_MISMATCH = "S4017" Error "event-mismatch": "Two classes take an event of one name with different fields, or the name of an event is a reserved word of the language of a property.";
    EVENT_UNTAKEN = "S4018" Warning "event-untaken" [OutlivesExpansion, WithoutEffect, AbsentComponent]: "The text of a property has an event that no component takes.";
    TOPIC_BETWEEN_NODES = "S4019" Error "topic-between-nodes" [Judgement, OutlivesExpansion]: "Components of different nodes use a topic, but one of them has no `url`, or they have different ones.";
    CREDENTIALS_IN_CLEAR = "S4020" Error "credentials-in-clear": "A user and a password are used beyond this machine without TLS.";
    OPEN_BROKER = "S4021" Error "open-broker": "A message broker that other machines reach asks for no password, or does not encrypt.";
    BROKERS_COLLIDE = "S4022" Error "brokers-collide": "Two message brokers of a fleet listen at one port.";
    NO_BROKER = "S4023" Warning "no-broker" [OutlivesExpansion, AbsentComponent]: "A `url` names a message broker that the fleet does not have, although it has another one.";
    NETWORK_SETTINGS_DIFFER = "S4024" Error "network-settings-differ": "Two components give different accounts or certificates for one `url`; a program has one connection to it.";
    TLS_SETTINGS = "S4025" Error "tls-settings": "The files for TLS are incomplete, or not used.";
    TOPIC_ON_NETWORKS = "S4026" Warning "topic-on-networks" [OutlivesExpansion]: "Components of two networks use one topic: they do not hear each other's programs.";
    ACCESS = "S4027" Error "access": "The access of users to topics cannot be enforced as it is written.";
    NETWORK_FILE = "S4028" Error "network-file": "A file or an environment variable that a network needs is missing or wrong. Reported by `saoms run`.";
    UNPROTECTED_NETWORK = "S4029" Warning "unprotected-network" [OutlivesExpansion]: "Messages leave this machine without protection: everybody in the network can read and change them.";
    PEER_MISSING = "S4030" Error "peer-missing": "A `url` of peers does not name a node that has a component on this network.";
    NO_TRANSPORT = "S4031" Error "no-transport": "There is no transport for a `url`: its scheme is unknown, or the library of the transport is missing. Reported by `saoms run`.";
    NODES_OVER_TOPICS = "S4032" Error "nodes-over-topics": "Components of several nodes are on a network that carries topics of other programs alone: nodes need a network of their own.";
    // S45: the loops of components.
    UNKNOWN_LOOP = "S4501" Error "unknown-loop": "A component does not have the named loop.";
    LOOP_REPEATED = "S4502" Error "loop-repeated": "A loop of a component is given twice.";
    LOOP_CONTRADICTION = "S4503" Error "loop-contradiction": "The attributes of a loop contradict each other.";
    LOOP_ORDER = "S4504" Error "loop-order": "The order of loops is circular, or refers to a removed loop.";
    LOOP_KNOWLEDGE = "S4505" Error "loop-knowledge": "A loop works on knowledge that the component does not have, or on the knowledge of another library.";
    UNKNOWN_ENTRY = "S4506" Error "unknown-entry": "A loop senses or effects an entry that the component does not have.";
    EFFECTOR_CLASH = "S4507" Error "effector-clash": "Two loops of a component change the same effector.";
    ENTRY_REPEATED = "S4508" Error "entry-repeated": "A loop adds an entry that already exists.";
    LOOP_REFERENCE = "S4509" Error "loop-reference": "A loop and its component have references with the same name, but with different interfaces.";
    LOOP_UNCHANGED = "S4510" Warning "loop-unchanged": "A `saoms:loop` element has no effect.";
    LOOP_UNSERVED = "S4511" Warning "loop-unserved" [OutlivesExpansion]: "A loop that replaces another one leaves entries that no loop effects or senses any more.";
}

/// The natures of a code of this table; `None` for that of a rule of a crate of components.
pub(crate) fn natures(id: &str) -> Option<&'static [Nature]> {
    let place = ALL.binary_search_by_key(&id, |code| code.id).ok()?;
    Some(NATURES[place])
}

fn is(id: &str, nature: Nature) -> bool {
    natures(id).is_some_and(|natures| natures.contains(&nature))
}

/// True if errors of a code are judgements on a fleet that could run: their severity can be lowered. So can that of
/// every rule of a crate of components.
pub fn is_judgement(code: &Code) -> bool {
    natures(code.id).is_none_or(|natures| natures.contains(&Nature::Judgement))
}

/// True if `saoms expand` leaves a fault of this code in what it writes, as it does with those of every rule of a crate
/// of components.
pub fn outlives_expansion(code: &Code) -> bool {
    natures(code.id).is_none_or(|natures| natures.contains(&Nature::OutlivesExpansion))
}

/// True if a code is one of those that the wiring report adds.
pub fn is_of_wiring(id: &str) -> bool {
    is(id, Nature::OfWiring)
}

/// True if a code says that what it is at has no effect.
pub fn is_without_effect(code: &Code) -> bool {
    is(code.id, Nature::WithoutEffect)
}
