//! Assemblies of composites without faults.

use std::fmt::Write as _;
use std::path::Path;
use std::sync::Arc;

use expect_test::expect;
use saoms_api::host::{DynComponent, PropertyValue, Registration, SmolStr};
use saoms_api::{Failure, Properties};
use saoms_lang::assembly::TaskProperties;
use saoms_lang::project::Project;
use saoms_lang::registry::Provider;
use saoms_tools::diagnostics::human_of;

use crate::check::classes::{Gps, registry};
use crate::check::support::{fleet, fleet_1_0, run, shown};

/// The assembly as text, after the warnings.
fn assembly(texts: &[&str], settings: &[&str]) -> String {
    let (assembly, diagnostics, sources) = run(texts, settings);
    let mut out: String = diagnostics.iter().map(|one| shown(one, &sources)).collect();
    let Some(assembly) = assembly else { return out };
    for (place, component) in assembly.components.iter().enumerate() {
        let _ = writeln!(out, "{place} {} is a {}", component.path, component.class.name());
        for (name, value) in &component.values {
            let _ = writeln!(out, "  {name} = {value:?}");
        }
        for wire in &component.references {
            let targets = wire.targets.iter().map(|target| format!("{} {}", target.component, target.service));
            let targets: Vec<String> = targets.collect();
            let target = if targets.is_empty() { "nothing".to_owned() } else { targets.join(", ") };
            let _ = writeln!(out, "  {} ({}) -> {target}", wire.reference, wire.interface);
        }
        if let Some(task) = &component.task {
            let _ = writeln!(out, "  {task:?}");
        }
    }
    out
}

#[test]
fn values_presets_wires_and_tasks() {
    let text = fleet(
        r#"<property name="pace">250us</property>
<component name="N"><implementation.rust class="example.Navigator"/><reference name="wheels" target="R"/></component>
<component name="R"><implementation.java class="example.Robot001"/>
<property name="ID">Robot</property>
<property name="period" source="$pace"/>
<property name="charger"><y xmlns="">4</y><x xmlns="">3</x></property>
<property name="stops"><value>1</value></property>
<property name="topicRename">POSTOPIC::pos</property>
<property name="restart">onFailure</property>
<reference name="gps" target="G/position"/></component>
<component name="G"><implementation.java class="example.Gps"/></component>
<wire source="N/task" target="R/TaskInterface"/>"#,
    );
    expect![[r#"
        0 N is a example.Navigator
          wheels (example.Wheels) -> 1 move
          task (unibg.robotics.tca.TaskInterface) -> 1 TaskInterface
        1 R is a example.Robot001
          ID = Text("Robot")
          number = Integer(1)
          charger = Complex([("x", Integer(3)), ("y", Integer(4))])
          stops = Many([Integer(1)])
          gps (example.Positions) -> 2 position
          TaskProperties { id: "Robot", period: 2s, delay: 0ns, run_on_startup: true, may_interrupt_if_running: true, use_jms: true, url: None, user: None, password: None, password_file: None, tls_ca: None, tls_certificate: None, tls_key: None, topic_rename: TopicRenames([("POSTOPIC", "pos")]), overrun: Skip, restart: OnFailure, restart_backoff: 100ms, restart_limit: 5, deadline: None, trigger: TopicList([]), minimum: 1ms, queue: None, loss: Fail }
        2 G is a example.Gps
          other (example.Positions) -> nothing
    "#]].assert_eq(&assembly(&[&text], &["pace=2 s"]));
}

#[test]
fn the_files_of_the_manual() {
    let broker = r#"<?xml version="1.0" encoding="UTF-8"?>
<composite xmlns="http://www.osoa.org/xmlns/sca/1.0"
    targetNamespace="http://launch" name="launchbroker">

    <component name="MessageBrokerComponent">
        <implementation.java
            class="unibg.robotics.tca.MessageBrokerImpl" />
        <property name="IP">localhost</property>
        <property name="port">61616</property>
    </component>
</composite>"#;
    let tasks = fleet_1_0(
        r#"<component name="Robot001">
        <implementation.java class="robot.Robot001" />
        <property name="ID">Robot001</property>
        <property name="period">1000</property>
        <property name="delay">0</property>
        <property name="runOnStartup">true</property>
        <property name="mayInterruptIfRunning">true</property>
        <property name="useJMS">true</property>
        <property name="url">localhost:61616</property>
        <property name="topicRename">POS001, pos001::POS002, pos002</property>
        <service name="TaskInterface">
            <interface.java interface="unibg.robotics.tca.TaskInterface" />
        </service>
    </component>"#,
    );
    expect![[r#"
        more.composite:11:38-44 warning S4003: class `robot.Robot001` uses no topic `POS001`: nothing is renamed
          help: topics that keep their names are `ORDERS` and `POSTOPIC`
        more.composite:11:54-60 warning S4003: class `robot.Robot001` uses no topic `POS002`: nothing is renamed
          help: topics that keep their names are `ORDERS` and `POSTOPIC`
        0 MessageBrokerComponent is a unibg.robotics.tca.MessageBrokerImpl
          IP = Text("localhost")
          port = Integer(61616)
        1 Robot001 is a robot.Robot001
          ID = Text("Robot001")
          number = Integer(1)
          gps (example.Positions) -> nothing
          TaskProperties { id: "Robot001", period: 1s, delay: 0ns, run_on_startup: true, may_interrupt_if_running: true, use_jms: true, url: Some("localhost:61616"), user: None, password: None, password_file: None, tls_ca: None, tls_certificate: None, tls_key: None, topic_rename: TopicRenames([("POS001", "pos001"), ("POS002", "pos002")]), overrun: Skip, restart: Never, restart_backoff: 100ms, restart_limit: 5, deadline: None, trigger: TopicList([]), minimum: 1ms, queue: None, loss: Fail }
    "#]].assert_eq(&assembly(&[broker, &tasks], &[]));
}

#[test]
fn values_have_the_order_of_the_class_however_they_are_written() {
    let lines = [
        r#"<property name="ID">R1</property>"#,
        r#"<property name="period">1s</property>"#,
        r#"<property name="number">7</property>"#,
        r#"<property name="queue">9</property>"#,
        r#"<property name="awake">false</property>"#,
        r#"<property name="stops"><value>1</value><value>2</value></property>"#,
    ];
    // All components of one fleet, since what one gives is held against what the one before gave.
    let mut orders: Vec<Vec<&str>> =
        (0..lines.len()).map(|first| [&lines[first..], &lines[..first]].concat()).collect();
    orders.extend(orders.clone().into_iter().map(|order| order.into_iter().rev().collect()));
    let components = orders.iter().enumerate().map(|(place, order)| {
        let properties = order.concat().replace("R1", &format!("R{place}")).replace(">7<", &format!(">{}<", place + 1));
        format!("<component name=\"R{place}\"><implementation.java class=\"example.Robot\"/>{properties}</component>\n")
    });
    let (assembly, diagnostics, _) = run(&[&fleet(&components.collect::<String>())], &[]);
    assert_eq!(diagnostics.iter().map(|one| &one.message).collect::<Vec<_>>(), Vec::<&String>::new());
    let assembly = assembly.unwrap();
    assert_eq!(assembly.components.len(), 2 * lines.len());
    for (place, component) in assembly.components.iter().enumerate() {
        let values: Vec<String> = component.values.iter().map(|(name, value)| format!("{name}={value:?}")).collect();
        let expected = format!(
            r#"ID=Text("R{place}") number=Integer({}) awake=Boolean(false) stops=Many([Integer(1), Integer(2)])"#,
            place + 1
        );
        assert_eq!(values.join(" "), expected);
        let task = component.task.as_ref().unwrap();
        assert_eq!((task.id.as_str(), task.period.as_secs(), task.queue), (&*format!("R{place}"), 1, Some(9)));
    }
}

/// A class of a library, of which nothing is known here but its declaration.
#[derive(Debug)]
struct Declared;

impl Provider for Declared {
    fn construct(&self, _: &[(SmolStr, PropertyValue)]) -> Result<Box<dyn DynComponent>, Failure> {
        Registration::of::<Gps>().construct(&[])
    }

    fn origin(&self) -> Option<&Path> {
        None
    }
}

/// Where it reads the `ID` of its task, as another type, class and task each have it as their own declaration says.
#[test]
fn names_of_task_properties_are_kept() {
    let refused = |name: &str| {
        let properties = format!(r#"[{{"name": "{name}", "type": "string"}}]"#);
        let class = |kind: &str| {
            format!(r#"{{"contract": 1, "class": "lib.Timer", "kind": "{kind}", "properties": {properties}}}"#)
        };
        assert!(registry().add_provided(&class("passive"), Arc::new(Declared)).is_ok());
        registry().add_provided(&class("periodic"), Arc::new(Declared)).err().map(|error| error.to_string())
    };
    for name in TaskProperties::NAMES.iter().filter(|name| **name != "ID").chain(&["trigger", "minimum", "node"]) {
        let expected = format!("property `{name}` has a name that is reserved for the task of a periodic component");
        assert!(refused(name).is_some_and(|message| message.contains(&expected)), "{name}");
    }
    assert_eq!(refused("ID"), None);
}

#[test]
fn values_have_the_types_that_a_library_declares() {
    let properties = r#"[{"name": "ID", "type": "integer"}, {"name": "wait", "type": "duration", "max": "1s"},
        {"name": "large", "type": "integer"}, {"name": "mode", "type": "enumeration", "allowed": ["slow", "fast"]}]"#;
    let class = format!(r#"{{"contract": 1, "class": "lib.Timer", "kind": "periodic", "properties": {properties}}}"#);
    let mut registry = registry();
    registry.add_provided(&class, Arc::new(Declared)).unwrap();
    let timer = |id: &str, wait: &str| {
        let large = "123456789012345678901234567890";
        let text = fleet(&format!(
            r#"<component name="T"><implementation.rust class="lib.Timer"/><property name="ID" value="{id}"/>
<property name="period" value="0250"/><property name="useJMS">false</property><property name="wait">{wait}</property>
<property name="large">{large}</property><property name="mode" value=" fast "/></component>"#
        ));
        Project::new().in_memory().text("t", &*text).compile(&registry)
    };
    let compilation = timer("007", "1000");
    let assembly = compilation.output.as_ref().unwrap();
    let values: Vec<String> =
        assembly.components[0].values.iter().map(|(name, value)| format!("{name}={value:?}")).collect();
    assert_eq!(
        values.join(" "),
        "ID=Integer(7) wait=Duration(1s) large=Integer(123456789012345678901234567890) mode=Text(\"fast\")"
    );
    let task = assembly.components[0].task.as_ref().unwrap();
    assert_eq!((task.id.as_str(), task.period.as_millis(), task.use_jms), ("007", 250, false));
    assert!(human_of(&timer("seven", "1001")).contains("property `wait`: `1001` is out of range"));
    assert!(human_of(&timer("seven", "1000")).contains("property `ID`: `seven` is not a whole number"));
}
