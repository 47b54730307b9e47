//! `saoms schema`: writes the language of composites as XML schemas, for editors.

use std::fs;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use saoms_tools::xsd::{Xsd, catalog, schemas};

use crate::Exit;
use crate::arguments::PluginArguments;
use crate::output::{Asked, Outputs, Place, Refused, print};
use crate::plugins::{files_read, registry};

const EXIT_CODES: &str = "\
Exit codes:
  0  written; the names of the files are on standard output
  1  a file could not be written
  2  a plugin cannot be used, or would be written over";

/// Write the language of composites, with all classes and properties, as XML schemas for editors
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct SchemaArguments {
    /// The folder for the schemas, one for each namespace, and for `catalog.xml`, by which editors find them; made if
    /// it is not there
    #[arg(short, long, value_name = "FOLDER")]
    pub(crate) output: PathBuf,

    /// The version of XML Schema: 1.0, which every editor reads, or 1.1, which also holds components to the properties
    /// of their classes
    #[arg(long, value_enum, value_name = "VERSION", default_value_t = XsdVersion::V1_0)]
    pub(crate) xsd: XsdVersion,

    #[command(flatten)]
    pub(crate) plugins: PluginArguments,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum XsdVersion {
    #[value(name = "1.0")]
    V1_0,
    #[value(name = "1.1")]
    V1_1,
}

/// The file by which editors find a schema from a namespace.
const CATALOG: &str = "catalog.xml";

pub(crate) fn schema(arguments: &SchemaArguments) -> Exit {
    let registry = match registry(&arguments.plugins) {
        Ok(registry) => registry,
        Err(exit) => return exit,
    };
    let xsd = match arguments.xsd {
        XsdVersion::V1_0 => Xsd::V1_0,
        XsdVersion::V1_1 => Xsd::V1_1,
    };
    let folder = &arguments.output;
    let schemas = schemas(&registry, xsd);
    let catalog = catalog(&schemas);
    let texts = schemas.iter().map(|schema| (folder.join(schema.file), &schema.text));
    let texts: Vec<(PathBuf, &String)> = texts.chain([(folder.join(CATALOG), &catalog)]).collect();
    match write(folder, &texts, files_read(&arguments.plugins)) {
        Ok(()) => {
            texts.iter().for_each(|(path, _)| print(&format!("{}\n", path.display())));
            Exit::Done
        }
        Err(refused) => refused.told(),
    }
}

/// Writes all texts, beside files that are read.
fn write(folder: &Path, texts: &[(PathBuf, &String)], read: Vec<PathBuf>) -> Result<(), Refused> {
    let asked = |path| Asked { what: "schema", option: "--output", path, grows: false };
    fs::create_dir_all(folder).map_err(|error| Refused::Unwritable(asked(folder).unwritable(&error)))?;
    let mut outputs = Outputs::beside(read);
    // None is written where one is refused.
    let places: Vec<Place> = texts.iter().map(|(path, _)| outputs.add(asked(path))).collect::<Result<_, _>>()?;
    for (place, (path, text)) in places.into_iter().zip(texts) {
        let written = place.open().and_then(|sink| sink.write(|to| to.write_all(text.as_bytes())));
        written.map_err(|error| Refused::Unwritable(asked(path).unwritable(&error)))?;
    }
    Ok(())
}
