//! The scenarios of the manual's chapter 8 in virtual time: the facts of its figures, to the execution number and the
//! battery's value.

mod critical;
mod figures;
mod fleet;
mod master;
mod reasons;
mod run;
mod scenario1;
mod scenario2;
mod scenario3;
mod situations;
mod story;
mod usecases;
