/// The version of this crate, for the metadata of a library.
pub const API: &str = env!("CARGO_PKG_VERSION");

/// Offers classes, loops and [rules over whole fleets](crate::rule::FleetRule) in a library, to programs that load it.
///
/// Exports a crate that is built as a `cdylib` as a plugin, with its `classes`, `loops` and `rules`, in this order and
/// each optional. The same crate can be linked into a program, too: its classes and loops are registered by their
/// derives then, its rules by this, as by [`fleet_rules!`](crate::fleet_rules).
///
/// ```
/// use saoms_api::{Class, Component, Failure};
///
/// /// Says nothing.
/// #[derive(Class)]
/// #[class(name = "example.Quiet", periodic)]
/// struct Quiet;
///
/// impl Component for Quiet {
///     type Properties = ();
///
///     fn new((): ()) -> Result<Self, Failure> {
///         Ok(Quiet)
///     }
/// }
///
/// saoms_api::plugin! {
///     classes: [Quiet],
/// }
/// # fn main() {}
/// ```
#[macro_export]
macro_rules! plugin {
    (
        $(classes: [$($class:ty),* $(,)?])?
        $(, loops: [$($looping:ty),* $(,)?])?
        $(, rules: [$($rule:path),* $(,)?])? $(,)?
    ) => {
        $crate::plugin! { @ [$($($class),*)?] [$($($looping),*)?] [$($($rule),*)?] }
    };
    (loops: [$($looping:ty),* $(,)?] $(, rules: [$($rule:path),* $(,)?])? $(,)?) => {
        $crate::plugin! { @ [] [$($looping),*] [$($($rule),*)?] }
    };
    (rules: [$($rule:path),* $(,)?] $(,)?) => {
        $crate::plugin! { @ [] [] [$($rule),*] }
    };
    (@ [$($class:ty),*] [$($looping:ty),*] [$($rule:path),*]) => {
        $crate::fleet_rules!($($rule),*);

        const _: () = {
            use $crate::generated::{
                ClassTable, LoopClassTable, PluginTable, RuleTable, Text, class_table, loop_class_table, rule_table,
            };

            const CLASSES: &[Text] = &[$(
                Text::Plain(","), Text::Plain(<$class as $crate::Class>::DECLARATION),
            )*];
            const LOOPS: &[Text] = &[$(
                Text::Plain(","), Text::Plain(<$looping as $crate::LoopClass>::DECLARATION),
            )*];
            const RULES: &[Text] = &[$(
                Text::Plain(","),
                Text::Plain("{\"code\":"),
                Text::Quoted($rule.code.id),
                Text::Plain(",\"name\":"),
                Text::Quoted($rule.code.name),
                Text::Plain(",\"meaning\":"),
                Text::Quoted($rule.code.meaning),
                Text::Plain(",\"severity\":"),
                Text::Quoted($rule.code.severity.name()),
                Text::Plain(",\"rule\":"),
                match $rule.code.rule {
                    Some(rule) => Text::Quoted(rule),
                    None => Text::Plain("null"),
                },
                Text::Plain(if $rule.judges_parts { ",\"judgesParts\":true" } else { ",\"judgesParts\":false" }),
                Text::Plain(if $rule.prevents_start { ",\"preventsStart\":true}" } else { ",\"preventsStart\":false}" }),
            )*];
            const TEXT: Text = Text::Joined(&[
                Text::Plain("{\"saoms\":\"plugin\",\"abi\":1,\"api\":"),
                Text::Quoted($crate::generated::API),
                Text::Plain(",\"package\":"),
                Text::Quoted(env!("CARGO_PKG_NAME")),
                Text::Plain(",\"version\":"),
                Text::Quoted(env!("CARGO_PKG_VERSION")),
                Text::Plain(",\"panic\":"),
                Text::Quoted(if cfg!(panic = "abort") { "abort" } else { "unwind" }),
                Text::Plain(",\"entry\":"),
                Text::Quoted(concat!("saoms_plugin_", env!("CARGO_CRATE_NAME"))),
                Text::Plain(",\"classes\":["),
                Text::Joined(CLASSES.split_at(if CLASSES.is_empty() { 0 } else { 1 }).1),
                Text::Plain("],\"loops\":["),
                Text::Joined(LOOPS.split_at(if LOOPS.is_empty() { 0 } else { 1 }).1),
                Text::Plain("],\"rules\":["),
                Text::Joined(RULES.split_at(if RULES.is_empty() { 0 } else { 1 }).1),
                Text::Plain("]}"),
            ]);

            #[used]
            #[unsafe(link_section = ".saoms.plugin")]
            static METADATA: [u8; TEXT.length()] = TEXT.bytes();

            static TABLES: &[&ClassTable] = &[$(&class_table::<$class>()),*];
            static LOOP_TABLES: &[&LoopClassTable] = &[$(&loop_class_table::<$looping>()),*];
            static RULE_TABLES: &[&RuleTable] = &[$(&rule_table(&$rule)),*];
            static TABLE: PluginTable = PluginTable::new(&METADATA, TABLES, LOOP_TABLES, RULE_TABLES);

            #[unsafe(export_name = concat!("saoms_plugin_", env!("CARGO_CRATE_NAME")))]
            extern "C" fn entry(_version: u32) -> *const PluginTable {
                $crate::generated::install_hook();
                &raw const TABLE
            }
        };
    };
}
