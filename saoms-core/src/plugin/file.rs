//! The section of a library that holds its metadata, read without running anything.

use std::fs::{self, File};
use std::io::Read;
use std::path::Path;

use object::elf::{self, FileHeader64, Machine};
use object::read::elf::{FileHeader as _, ProgramHeader as _, SectionHeader as _};
use object::{Endianness, FileKind, ReadCache};

use super::PluginError;

/// The machine that this program runs on, as ELF files say it.
const MACHINE: Machine = if cfg!(target_arch = "aarch64") { elf::EM_AARCH64 } else { elf::EM_X86_64 };

/// Larger files are no libraries of components.
const LARGEST: u64 = 4 << 30;

/// Longer texts are no metadata: those of a hundred classes have some hundred kilobytes.
const LARGEST_METADATA: u64 = 64 << 20;

/// The text of the section of this name.
pub(crate) fn read_section(path: &Path, section: &str) -> Result<String, PluginError> {
    let path_of = || path.to_owned();
    let unreadable = |message: String| PluginError::Unreadable { path: path_of(), message };
    let about = fs::metadata(path).map_err(|error| unreadable(error.to_string()))?;
    if !about.is_file() {
        return Err(unreadable("it is neither a file nor a folder".to_owned()));
    }
    if about.len() > LARGEST {
        return Err(unreadable(format!("it has {} bytes", about.len())));
    }
    // No more of it is read than is looked at: it may be huge, and nobody has named it.
    let mut file = File::open(path).map_err(|error| unreadable(error.to_string()))?;
    // What cannot be read at all is told as such, and not as a file of another kind.
    file.read(&mut [0; 16]).map_err(|error| unreadable(error.to_string()))?;
    let bytes = &ReadCache::new(file);
    let broken = |error: object::Error| PluginError::Broken { path: path_of(), message: error.to_string() };
    match FileKind::parse(bytes) {
        Ok(FileKind::Elf64) => {}
        Ok(FileKind::Elf32) => {
            return Err(PluginError::Machine { path: path_of(), found: "a 32-bit machine".to_owned() });
        }
        _ => return Err(PluginError::NoLibrary { path: path_of() }),
    }
    let header = FileHeader64::<Endianness>::parse(bytes).map_err(broken)?;
    let endian = header.endian().map_err(broken)?;
    let machine = header.e_machine(endian);
    if machine != MACHINE {
        return Err(PluginError::Machine { path: path_of(), found: name(machine) });
    }
    if header.e_type(endian) != elf::ET_DYN {
        return Err(PluginError::NoLibrary { path: path_of() });
    }
    // A segment beyond the end of the file would end the program when it is touched.
    let size = about.len();
    for segment in header.program_headers(endian, bytes).map_err(broken)? {
        let end = segment.p_offset(endian).checked_add(segment.p_filesz(endian));
        if end.is_none_or(|end| end > size) {
            let message = "a part of it lies beyond its end".to_owned();
            return Err(PluginError::Broken { path: path_of(), message });
        }
    }
    let sections = header.sections(endian, bytes).map_err(broken)?;
    let Some((_, section)) = sections.section_by_name(endian, section.as_bytes()) else {
        return Err(PluginError::NoMetadata { path: path_of() });
    };
    if section.sh_size(endian) > LARGEST_METADATA {
        let message = format!("they have {} bytes", section.sh_size(endian));
        return Err(PluginError::Metadata { path: path_of(), message });
    }
    let data = section.data(endian, bytes).map_err(broken)?;
    // A text of a C compiler ends with zeros.
    let end = data.iter().rposition(|byte| *byte != 0).map_or(0, |last| last + 1);
    let text = data.get(..end).unwrap_or_default().to_vec();
    String::from_utf8(text)
        .map_err(|error| PluginError::Metadata { path: path_of(), message: format!("they are not text: {error}") })
}

fn name(machine: Machine) -> String {
    match machine.0 {
        62 => "x86_64".to_owned(),
        183 => "aarch64".to_owned(),
        243 => "riscv64".to_owned(),
        other => format!("machine {other} of the ELF format"),
    }
}
