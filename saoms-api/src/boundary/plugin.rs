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
                ClassTable, LoopClassTable, PluginTable, RuleTable, ConstText, class_table, loop_class_table, rule_table,
            };

            const CLASSES: &[ConstText] = &[$(
                ConstText::Plain(","), ConstText::Plain(<$class as $crate::Class>::DECLARATION),
            )*];
            const LOOPS: &[ConstText] = &[$(
                ConstText::Plain(","), ConstText::Plain(<$looping as $crate::LoopClass>::DECLARATION),
            )*];
            const RULES: &[ConstText] = &[$(
                ConstText::Plain(","),
                ConstText::Plain("{\"code\":"),
                ConstText::Quoted($rule.code.id),
                ConstText::Plain(",\"name\":"),
                ConstText::Quoted($rule.code.name),
                ConstText::Plain(",\"meaning\":"),
                ConstText::Quoted($rule.code.meaning),
                ConstText::Plain(",\"severity\":"),
                ConstText::Quoted($rule.code.severity.name()),
                ConstText::Plain(",\"rule\":"),
                match $rule.code.rule {
                    Some(rule) => ConstText::Quoted(rule),
                    None => ConstText::Plain("null"),
                },
                ConstText::Plain(if $rule.judges_parts { ",\"judgesParts\":true" } else { ",\"judgesParts\":false" }),
                ConstText::Plain(if $rule.prevents_start { ",\"preventsStart\":true}" } else { ",\"preventsStart\":false}" }),
            )*];
            const TEXT: ConstText = ConstText::Joined(&[
                ConstText::Plain("{\"saoms\":\"plugin\",\"abi\":3,\"api\":"),
                ConstText::Quoted($crate::generated::API),
                ConstText::Plain(",\"package\":"),
                ConstText::Quoted(env!("CARGO_PKG_NAME")),
                ConstText::Plain(",\"version\":"),
                ConstText::Quoted(env!("CARGO_PKG_VERSION")),
                ConstText::Plain(",\"panic\":"),
                ConstText::Quoted(if cfg!(panic = "abort") { "abort" } else { "unwind" }),
                ConstText::Plain(",\"entry\":"),
                ConstText::Quoted(concat!("saoms_plugin_", env!("CARGO_CRATE_NAME"))),
                ConstText::Plain(",\"classes\":["),
                ConstText::Joined(CLASSES.split_at(if CLASSES.is_empty() { 0 } else { 1 }).1),
                ConstText::Plain("],\"loops\":["),
                ConstText::Joined(LOOPS.split_at(if LOOPS.is_empty() { 0 } else { 1 }).1),
                ConstText::Plain("],\"rules\":["),
                ConstText::Joined(RULES.split_at(if RULES.is_empty() { 0 } else { 1 }).1),
                ConstText::Plain("]}"),
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
