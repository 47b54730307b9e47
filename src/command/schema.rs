//! `saoms schema`: writes the language of composites as XML schemas, for editors, or messages and services as a package
//! of ROS 2.

mod package;

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use saoms_tools::xsd::{Xsd, catalog, schemas};

use crate::Exit;
use crate::arguments::PluginArguments;
use crate::output::{eprint, print, write_into};
use crate::plugins::{files_read, registry};

const EXIT_CODES: &str = "\
Exit codes:
  0  written; the names of the files are on standard output
  1  a file could not be written
  2  the folder is a file, or a plugin cannot be used or would be written over";

/// Write the language of composites, with all classes and properties, as XML schemas for editors
#[derive(Debug, Args)]
#[command(after_help = EXIT_CODES)]
pub(crate) struct SchemaArguments {
    /// The folder for the schemas, one for each namespace, and for `catalog.xml`, which helps editors to find them; it
    /// is made if it does not exist
    #[arg(short, long, value_name = "FOLDER")]
    pub(crate) output: PathBuf,

    /// The version of XML Schema: 1.0, which every editor reads, or 1.1, which also checks the properties of components
    #[arg(long, value_enum, value_name = "VERSION", default_value_t = XsdVersion::V1_0)]
    pub(crate) xsd: XsdVersion,

    /// Write messages and services as a package of ROS 2 interfaces, `saoms_msgs`, in place of XML schemas
    #[arg(long, conflicts_with = "xsd")]
    pub(crate) ros2: bool,

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
    let folder = &arguments.output;
    if arguments.ros2 {
        let files = match package::files(&registry) {
            Ok(files) => files,
            Err(fault) => {
                eprint(&format!("error: {fault}\n"));
                return Exit::WrongInput;
            }
        };
        let texts: Vec<(PathBuf, &String)> = files.iter().map(|(name, text)| (folder.join(name), text)).collect();
        return written(folder, &texts, arguments);
    }
    let xsd = match arguments.xsd {
        XsdVersion::V1_0 => Xsd::V1_0,
        XsdVersion::V1_1 => Xsd::V1_1,
    };
    let schemas = schemas(&registry, xsd);
    let catalog = catalog(&schemas);
    let texts = schemas.iter().map(|schema| (folder.join(schema.file), &schema.text));
    let texts: Vec<(PathBuf, &String)> = texts.chain([(folder.join(CATALOG), &catalog)]).collect();
    written(folder, &texts, arguments)
}

/// Writes files, and says which.
fn written(folder: &Path, texts: &[(PathBuf, &String)], arguments: &SchemaArguments) -> Exit {
    match write_into("schema", folder, texts, files_read(&arguments.plugins)) {
        Ok(()) => {
            texts.iter().for_each(|(path, _)| print(&format!("{}\n", path.display())));
            Exit::Done
        }
        Err(refused) => refused.told(),
    }
}
