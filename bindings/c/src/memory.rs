//! The caller's memory, checked before it is used.

use core::mem::{MaybeUninit, needs_drop};
use core::ops::Range;

use crate::Error;

/// A structure of the library in the caller's memory.
#[repr(C)]
#[derive(Debug, Clone, Copy)]
pub struct Kept {
    /// Says what the words hold.
    tag: usize,
    /// The structure.
    words: [MaybeUninit<usize>; 16],
}

impl Kept {
    /// Keeps `value`. The tag is a number that no memory holds by chance, and stands for T alone.
    pub fn new<T>(tag: usize, value: T) -> Kept {
        const {
            assert!(
                size_of::<T>() <= size_of::<[usize; 16]>()
                    && align_of::<T>() <= align_of::<usize>()
            );
            assert!(!needs_drop::<T>());
        }
        let mut words = [MaybeUninit::uninit(); 16];
        // SAFETY: the words have room for the value, and its alignment. It has nothing to drop.
        unsafe { words.as_mut_ptr().cast::<T>().write(value) };
        Kept { tag, words }
    }

    /// What is kept at an address.
    ///
    /// # Safety
    /// As the crate says; what the value points to is where it was.
    pub unsafe fn get<'a, T>(place: *const Kept, tag: usize) -> Result<&'a T, Error> {
        check(place)?;
        // SAFETY: neither null nor unaligned; by its tag, `new` wrote the words.
        let kept = unsafe { &*place };
        match kept.tag == tag {
            true => Ok(unsafe { &*kept.words.as_ptr().cast::<T>() }),
            false => Err(Error::NotInitialised),
        }
    }

    /// What is kept at an address, to change it.
    ///
    /// # Safety
    /// As of [`Kept::get`]; nothing else uses it meanwhile.
    pub unsafe fn get_mut<'a, T>(place: *mut Kept, tag: usize) -> Result<&'a mut T, Error> {
        check(place)?;
        // SAFETY: as above.
        let kept = unsafe { &mut *place };
        match kept.tag == tag {
            true => Ok(unsafe { &mut *kept.words.as_mut_ptr().cast::<T>() }),
            false => Err(Error::NotInitialised),
        }
    }
}

/// Checks an address.
fn check<T>(start: *const T) -> Result<(), Error> {
    if start.is_null() {
        return Err(Error::NullPointer);
    }
    start.is_aligned().then_some(()).ok_or(Error::Unaligned)
}

/// Checks a list; an empty one may have any address.
fn check_list<T>(start: *const T, length: usize) -> Result<(), Error> {
    if length > isize::MAX as usize / size_of::<T>() {
        return Err(Error::Length);
    }
    if length == 0 { Ok(()) } else { check(start) }
}

/// The value at an address.
///
/// # Safety
/// As the crate says.
pub unsafe fn read<T: Copy>(place: *const T) -> Result<T, Error> {
    check(place)?;
    // SAFETY: neither null nor unaligned; the caller says that a T is there.
    Ok(unsafe { place.read() })
}

/// A list of the caller's.
///
/// # Safety
/// As the crate says; nothing writes to the list while the slice is in use.
pub unsafe fn list<'a, T>(start: *const T, length: usize) -> Result<&'a [T], Error> {
    check_list(start, length)?;
    match length {
        0 => Ok(&[]),
        // SAFETY: neither null, unaligned nor too long; the caller says that the elements are there.
        _ => Ok(unsafe { core::slice::from_raw_parts(start, length) }),
    }
}

/// A list of the caller's to write to.
///
/// # Safety
/// As the crate says; nothing else reads or writes the list while the slice is in use.
pub unsafe fn list_mut<'a, T>(start: *mut T, length: usize) -> Result<&'a mut [T], Error> {
    check_list(start, length)?;
    match length {
        0 => Ok(&mut []),
        // SAFETY: neither null, unaligned nor too long; the caller says that the elements are there and not in use.
        _ => Ok(unsafe { core::slice::from_raw_parts_mut(start, length) }),
    }
}

/// The addresses of a list; none of a null one.
pub fn bytes<T>(start: *const T, length: usize) -> Range<usize> {
    let length = if start.is_null() { 0 } else { length };
    let start = start.addr();
    start..start.saturating_add(length.saturating_mul(size_of::<T>()))
}

/// Refuses lists to write to that share memory with each other or with what is read.
///
/// Implements: CLB-003.
pub fn check_apart(written: &[Range<usize>], read: &[Range<usize>]) -> Result<(), Error> {
    let meet = |a: &Range<usize>, b: &Range<usize>| a.start.max(b.start) < a.end.min(b.end);
    for (number, one) in written.iter().enumerate() {
        let others = written.iter().skip(number + 1).chain(read);
        if others.into_iter().any(|other| meet(one, other)) {
            return Err(Error::Overlap);
        }
    }
    Ok(())
}

/// Writes a result to the caller, or says why there is none; then the place keeps what it holds.
///
/// # Safety
/// As the crate says.
///
/// Implements: CLB-014.
pub unsafe fn give<T>(place: *mut T, result: impl FnOnce() -> Result<T, Error>) -> Error {
    match check(place).and_then(|()| result()) {
        Ok(value) => {
            // SAFETY: neither null nor unaligned; the caller says that there is room for a T.
            unsafe { place.write(value) };
            Error::Ok
        }
        Err(error) => error,
    }
}
