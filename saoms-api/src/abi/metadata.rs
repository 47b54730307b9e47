use super::PluginTable;

/// The section of a library that holds its metadata: one JSON text, which is read before anything in the library runs.
///
/// | member | meaning |
/// | --- | --- |
/// | `saoms` | `"plugin"` |
/// | `abi` | the [`VERSION`](super::VERSION) of the boundary |
/// | `api` | the version of this crate that the library was built with, for people |
/// | `package`, `version` | those of the library, for people |
/// | `panic` | `unwind`; a library whose panics abort is refused |
/// | `entry` | the name of its function of type [`Entry`] |
/// | `classes` | the [declarations](crate::declaration) of its classes |
/// | `loops` | those of its loops |
pub const SECTION: &str = ".saoms.plugin";

/// The function by which a library gives its table: it takes the [`VERSION`](super::VERSION) of the program.
pub type Entry = unsafe extern "C" fn(version: u32) -> *const PluginTable;

/// Offers classes and loops in a library, to programs that load it.
///
/// A crate that is built as a `cdylib` says once what it offers. The same crate can be linked into a program, too: its classes are
/// registered by their derives then, and this has no part in it.
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
    (loops: [$($looping:ty),* $(,)?] $(,)?) => {
        $crate::plugin! { classes: [], loops: [$($looping),*] }
    };
    (classes: [$($class:ty),* $(,)?] $(,)?) => {
        $crate::plugin! { classes: [$($class),*], loops: [] }
    };
    (classes: [$($class:ty),* $(,)?], loops: [$($looping:ty),* $(,)?] $(,)?) => {
        const _: () = {
            use $crate::declaration::Text;

            const CLASSES: &[Text] = &[$(
                Text::Plain(","), Text::Plain(<$class as $crate::Class>::DECLARATION),
            )*];
            const LOOPS: &[Text] = &[$(
                Text::Plain(","), Text::Plain(<$looping as $crate::LoopClass>::DECLARATION),
            )*];
            const TEXT: Text = Text::Joined(&[
                Text::Plain("{\"saoms\":\"plugin\",\"abi\":1,\"api\":"),
                Text::Quoted($crate::abi::API),
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
                Text::Plain("]}"),
            ]);

            #[used]
            #[unsafe(link_section = ".saoms.plugin")]
            static METADATA: [u8; TEXT.length()] = TEXT.bytes();

            static TABLES: &[$crate::abi::ClassTable] = &[$($crate::abi::ClassTable::of::<$class>()),*];
            static LOOP_TABLES: &[$crate::abi::LoopClassTable] = &[$($crate::abi::LoopClassTable::of::<$looping>()),*];
            static TABLE: $crate::abi::PluginTable = $crate::abi::PluginTable::new(&METADATA, TABLES, LOOP_TABLES);

            #[unsafe(export_name = concat!("saoms_plugin_", env!("CARGO_CRATE_NAME")))]
            extern "C" fn entry(_version: u32) -> *const $crate::abi::PluginTable {
                $crate::contain::install_hook();
                &raw const TABLE
            }
        };
    };
}
