//! Ways to misbehave, by name.

use std::cell::RefCell;
use std::io::{Write, stdout};
use std::panic::{self, panic_any};
use std::sync::Mutex;
use std::time::Duration;
use std::{hint, ptr, thread};

use saoms_api::Failure;

/// A payload whose drop panics, and so on.
pub struct Nasty(pub u32);

impl Drop for Nasty {
    fn drop(&mut self) {
        if self.0 > 0 {
            panic_any(Nasty(self.0 - 1));
        }
    }
}

thread_local! {
    /// Its destructor panics.
    static LOCAL: RefCell<Option<Nasty>> = const { RefCell::new(None) };
}

/// Its destructor does not return.
struct Endless;

impl Drop for Endless {
    fn drop(&mut self) {
        thread::sleep(Duration::from_secs(3600));
    }
}

thread_local! {
    static ENDLESS: RefCell<Option<Endless>> = const { RefCell::new(None) };
}

/// Held for ever.
static LOCK: Mutex<()> = Mutex::new(());

/// Shared by all components.
static SHARED: Mutex<u32> = Mutex::new(0);

#[inline(never)]
fn overflow(depth: u64) -> u64 {
    let block = hint::black_box([depth; 512]);
    if block[0] == u64::MAX { 0 } else { overflow(depth + 1) + block[7] }
}

/// Misbehaves in this way.
pub fn act(does: &str, place: &str) -> Result<(), Failure> {
    match does {
        "panic" => panic!("no more of {place}"),
        "nasty" => panic_any(Nasty(3)),
        "block" => thread::sleep(Duration::from_millis(300)),
        "never" => loop {
            thread::sleep(Duration::from_secs(1));
        },
        "panic twice" => {
            let _second = Nasty(1);
            panic!("no more of {place}")
        }
        "fail" => return Err(format!("fails in {place}").into()),
        "fail at length" => return Err("x".repeat(10 << 20).into()),
        "panic at length" => panic!("{}", "x".repeat(10 << 20)),
        "fail with signs" => return Err("a\u{1b}[31m\r\n\0b".into()),
        "panic with signs" => panic!("a\u{1b}[31m\r\n\0b"),
        "fail without words" => return Err("".into()),
        "exit" => std::process::exit(0),
        "abort" => std::process::abort(),
        "overflow" => drop(overflow(1)),
        "allocate" => drop(hint::black_box(Vec::<u8>::with_capacity(isize::MAX as usize))),
        "capacity" => drop(hint::black_box(Vec::<u64>::with_capacity(usize::MAX))),
        "thread panics" => drop(thread::spawn(|| panic!("no more of a thread")).join()),
        "threads" => {
            let one =
                || drop(thread::Builder::new().stack_size(16 << 10).spawn(|| thread::sleep(Duration::from_secs(2))));
            (0..10_000).for_each(|_| one());
        }
        "local" => LOCAL.set(Some(Nasty(1))),
        "endless local" => ENDLESS.set(Some(Endless)),
        "local of a thread" => drop(thread::spawn(|| LOCAL.set(Some(Nasty(1)))).join()),
        "lock" => {
            let _held = LOCK.lock();
            let _never = LOCK.lock();
        }
        "poison" => {
            let _held = SHARED.lock().map_err(|_| "what is shared is poisoned")?;
            panic!("no more of {place}")
        }
        "share" => *SHARED.lock().map_err(|_| "what is shared is poisoned")? += 1,
        "catch" => drop(panic::catch_unwind(|| panic!("no more of {place}"))),
        "hook" => {
            panic::set_hook(Box::new(|_| {}));
            panic!("no more of {place}")
        }
        "hook panics" => {
            panic::set_hook(Box::new(|_| panic!("no more of a hook")));
            panic!("no more of {place}")
        }
        // SAFETY: none, which is what this is for.
        "null" => unsafe { ptr::null_mut::<u32>().write_volatile(hint::black_box(1)) },
        "unreachable" => {
            // SAFETY: as before.
            let impossible: fn() = || unsafe { hint::unreachable_unchecked() };
            hint::black_box(impossible)();
        }
        "misaligned" => {
            let bytes = hint::black_box([0_u8; 16]);
            // SAFETY: as before.
            let _ = unsafe { bytes.as_ptr().add(1).cast::<u64>().read() };
        }
        "index" => drop(hint::black_box(Vec::<u32>::new())[hint::black_box(3)]),
        // SAFETY: as before.
        "environment" => unsafe { std::env::set_var("SAOMS_TEST_VARIABLE", "changed") },
        "folder" => std::env::set_current_dir("/")?,
        "print" => (0..100_000).try_for_each(|_| writeln!(stdout(), "{}", "x".repeat(1023)))?,
        "forget" => std::mem::forget(vec![0_u8; 1 << 20]),
        "resume" => panic::resume_unwind(Box::new(Nasty(2))),
        other => panic!("what is {other}?"),
    }
    Ok(())
}
