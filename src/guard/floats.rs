//! How a thread rounds and traps floating-point numbers. Code of a library may change it, as what some compilers link
//! into libraries with `-ffast-math` does when it is loaded: components that run on that thread would compute other
//! numbers than elsewhere.

use std::sync::{Mutex, OnceLock, PoisonError};

use crate::output::eprint;

/// The control word of the program: as all of its threads begin.
static KEPT: OnceLock<u64> = OnceLock::new();

/// Keeps the mode of this thread as that of the program.
pub(super) fn keep() {
    KEPT.get_or_init(mode::get);
}

/// Gives this thread the mode of the program back, which is told once.
pub(super) fn take_back(who: &str, place: &str) {
    static TOLD: Mutex<Vec<String>> = Mutex::new(Vec::new());
    let Some(kept) = KEPT.get().filter(|kept| mode::get() != **kept) else { return };
    mode::set(*kept);
    let line = format!(
        "warning: {who} changed how floating-point numbers are rounded or trapped{place}: it is changed back; build it \
         without `-ffast-math`, and change it only while a function runs\n"
    );
    let mut told = TOLD.lock().unwrap_or_else(PoisonError::into_inner);
    // A check constructs each component, and a run once more.
    if !told.contains(&line) {
        eprint(&line);
        told.push(line);
    }
}

#[cfg(target_arch = "x86_64")]
mod mode {
    use std::arch::asm;

    /// All but the flags of what has happened.
    const MODE: u32 = 0xffc0;

    fn word() -> u32 {
        let mut word = 0_u32;
        // SAFETY: it writes four bytes to where there is room for them.
        unsafe { asm!("stmxcsr [{}]", in(reg) &raw mut word, options(nostack, preserves_flags)) };
        word
    }

    pub(super) fn get() -> u64 {
        u64::from(word() & MODE)
    }

    pub(super) fn set(mode: u64) {
        let word = word() & !MODE | mode as u32 & MODE;
        // SAFETY: the mode is one that this program had, in which compiled code expects to run.
        unsafe { asm!("ldmxcsr [{}]", in(reg) &raw const word, options(nostack, preserves_flags, readonly)) };
    }
}

#[cfg(target_arch = "aarch64")]
mod mode {
    use std::arch::asm;

    pub(super) fn get() -> u64 {
        let word: u64;
        // SAFETY: it reads a register that has no flags of what has happened.
        unsafe { asm!("mrs {}, fpcr", out(reg) word, options(nomem, nostack, preserves_flags)) };
        word
    }

    pub(super) fn set(mode: u64) {
        // SAFETY: the mode is one that this program had, in which compiled code expects to run.
        unsafe { asm!("msr fpcr, {}", in(reg) mode, options(nomem, nostack, preserves_flags)) };
    }
}

/// Of other processors nothing is known.
#[cfg(not(any(target_arch = "x86_64", target_arch = "aarch64")))]
mod mode {
    pub(super) fn get() -> u64 {
        0
    }

    pub(super) fn set(_: u64) {}
}
