//! What the repository says of itself: its documents, its editors, the order of its modules.

mod architecture;
mod editors;
mod messages;
mod pages;
mod programs;
mod readme;
