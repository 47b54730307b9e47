//! The repository: its documents, its files for editors, the order of its modules.

mod architecture;
mod comments;
mod composites;
mod editors;
mod messages;
mod pages;
mod programs;
mod readme;
mod records;
