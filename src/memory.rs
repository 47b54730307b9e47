//! Where the program's memory comes from.
//!
//! Most of a check's time goes to memory: a composite becomes many small pieces, and a few lists that grow with the file. The small ones come
//! from mimalloc, which takes and frees them faster than the system's allocator. Lists stay with the system, which moves a list that grows by
//! its page table where mimalloc copies it and holds both. Once one of them is very large, memory is asked for in huge pages, of which a file
//! of 100 MB needs some hundreds rather than a hundred thousand. Measured in `benches/README.md`.

use std::alloc::{GlobalAlloc, Layout, System};
#[cfg(target_os = "linux")]
use std::sync::atomic::{AtomicBool, Ordering};

use libmimalloc_sys::{
    mi_free, mi_malloc, mi_malloc_aligned, mi_realloc, mi_realloc_aligned, mi_zalloc, mi_zalloc_aligned,
};

/// What is at least so large, in bytes, comes from the system.
const LARGE: usize = 1 << 20;

/// The first list that is at least so large, in bytes, is asked for in huge pages, as the text of a file of some 100 MB: what all lists are
/// rounded up to is little of such a file, and much of what a small one may take that comes to many components.
#[cfg(target_os = "linux")]
const HUGE: usize = 92 << 20;

/// Each later one that is at least so large is, too.
#[cfg(target_os = "linux")]
const HUGE_LATER: usize = 4 << 20;

/// The allocator of the program.
pub(crate) struct Memory;

// SAFETY: every layout leads to one of two allocators by its size alone, and always to the same: what one of them gave is only given back
// to it, with the layout that it was given for. Between the two, `realloc` copies as much as both layouts hold.
unsafe impl GlobalAlloc for Memory {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        // SAFETY: what the caller promises of the layout.
        unsafe {
            if layout.size() < LARGE {
                Small::alloc(layout)
            } else {
                huge(System.alloc(layout), layout.size())
            }
        }
    }

    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        // SAFETY: what the caller promises of the layout.
        unsafe {
            if layout.size() < LARGE {
                Small::alloc_zeroed(layout)
            } else {
                huge(System.alloc_zeroed(layout), layout.size())
            }
        }
    }

    unsafe fn dealloc(&self, memory: *mut u8, layout: Layout) {
        // SAFETY: the caller gives the layout that the memory was asked for with, which leads to the allocator that gave it.
        unsafe { if layout.size() < LARGE { Small::dealloc(memory) } else { System.dealloc(memory, layout) } }
    }

    unsafe fn realloc(&self, memory: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: as above; the caller promises that `size` and the alignment make a layout. The copy stays inside of both pieces of memory,
        // which do not overlap as both are in use.
        unsafe {
            match (layout.size() < LARGE, size < LARGE) {
                (true, true) => Small::realloc(memory, layout, size),
                (false, false) => huge(System.realloc(memory, layout, size), size),
                _ => {
                    let new = self.alloc(Layout::from_size_align_unchecked(size, layout.align()));
                    if !new.is_null() {
                        memory.copy_to_nonoverlapping(new, size.min(layout.size()));
                        self.dealloc(memory, layout);
                    }
                    new
                }
            }
        }
    }
}

/// mimalloc, asked in its shorter way for what has no more than the alignment that all of its memory has.
struct Small;

impl Small {
    /// The alignment that all memory of mimalloc has, in bytes.
    const ALIGNMENT: usize = 8;

    unsafe fn alloc(layout: Layout) -> *mut u8 {
        // SAFETY: what the caller promises of the layout.
        unsafe {
            match layout.align() <= Self::ALIGNMENT {
                true => mi_malloc(layout.size()).cast(),
                false => mi_malloc_aligned(layout.size(), layout.align()).cast(),
            }
        }
    }

    unsafe fn alloc_zeroed(layout: Layout) -> *mut u8 {
        // SAFETY: what the caller promises of the layout.
        unsafe {
            match layout.align() <= Self::ALIGNMENT {
                true => mi_zalloc(layout.size()).cast(),
                false => mi_zalloc_aligned(layout.size(), layout.align()).cast(),
            }
        }
    }

    unsafe fn dealloc(memory: *mut u8) {
        // SAFETY: the caller gives memory that it got from here.
        unsafe { mi_free(memory.cast()) }
    }

    unsafe fn realloc(memory: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        // SAFETY: the caller gives memory that it got from here for this layout.
        unsafe {
            match layout.align() <= Self::ALIGNMENT {
                true => mi_realloc(memory.cast(), size).cast(),
                false => mi_realloc_aligned(memory.cast(), size, layout.align()).cast(),
            }
        }
    }
}

/// Asks for huge pages where that pays. It is advice: whatever comes of it, the memory is the same.
#[cfg(target_os = "linux")]
fn huge(memory: *mut u8, size: usize) -> *mut u8 {
    /// That of the processors that SAOMS runs on.
    const PAGE: usize = 2 << 20;
    const SMALL_PAGE: usize = 4 << 10;
    /// What mimalloc maps at once, in bytes.
    const AREA: usize = 1 << 30;
    static IS_ASKED: AtomicBool = AtomicBool::new(false);
    let is_first = !IS_ASKED.load(Ordering::Relaxed);
    if size < (if is_first { HUGE } else { HUGE_LATER }) || memory.is_null() {
        return memory;
    }
    // All of the mapping that the memory is in, from its start on: one of which a part alone has the advice cannot grow by its page table.
    let start = memory.map_addr(|at| at & !(SMALL_PAGE - 1));
    let length = (memory.addr() - start.addr() + size).next_multiple_of(SMALL_PAGE);
    // SAFETY: the range begins and ends with pages that the memory is in, and the advice changes nothing of what is in them.
    unsafe { libc::madvise(start.cast(), length, libc::MADV_HUGEPAGE) };
    // Where one list is so large, the small pieces of a model come to several times as much.
    if is_first && !IS_ASKED.swap(true, Ordering::Relaxed) {
        // SAFETY: the piece is given back to where it came from. What else may be mapped behind it is not changed by the advice either, and
        // what is not mapped is passed over.
        unsafe {
            let piece = mi_malloc(1);
            libc::madvise(piece.map_addr(|at| at & !(PAGE - 1)), AREA, libc::MADV_HUGEPAGE);
            mi_free(piece);
        }
    }
    memory
}

#[cfg(not(target_os = "linux"))]
fn huge(memory: *mut u8, _: usize) -> *mut u8 {
    memory
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_in_memory_survives_every_change_of_its_size() {
        const ALIGNMENT: usize = 64;
        let sizes =
            [3, 4096, LARGE - 1, LARGE, 3 * LARGE, 40 * LARGE, 100 * LARGE, 35 * LARGE, LARGE, 900, 5];
        let layout = |size| Layout::from_size_align(size, ALIGNMENT).unwrap();
        // SAFETY: each layout is that of the memory at that time, and no byte beyond it is touched.
        unsafe {
            let mut memory = Memory.alloc(layout(sizes[0]));
            memory.write_bytes(7, sizes[0]);
            for size in sizes.windows(2) {
                memory = Memory.realloc(memory, layout(size[0]), size[1]);
                assert!(!memory.is_null() && memory.addr().is_multiple_of(ALIGNMENT), "{size:?}");
                let kept = size[0].min(size[1]);
                let bytes = std::slice::from_raw_parts(memory, kept);
                assert!(bytes.iter().all(|byte| *byte == 7), "{size:?}");
                memory.add(kept).write_bytes(7, size[1] - kept);
            }
            Memory.dealloc(memory, layout(sizes[sizes.len() - 1]));
        }
    }

    #[test]
    fn memory_that_is_asked_for_empty_is_empty() {
        for size in [16, LARGE - 1, LARGE, 96 * LARGE] {
            let layout = Layout::from_size_align(size, 8).unwrap();
            // SAFETY: the layout is that of the memory, and no byte beyond it is read.
            unsafe {
                let memory = Memory.alloc_zeroed(layout);
                assert!(std::slice::from_raw_parts(memory, size).iter().all(|byte| *byte == 0), "{size}");
                Memory.dealloc(memory, layout);
            }
        }
    }
}
