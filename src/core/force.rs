//! A force on the probe, by its two components.
//!
//! ```
//! use palpate_core::force::Force;
//!
//! let noise = Force::new(0.05, 0.1);
//! assert_eq!(noise.map(|sd| 2.0 * sd), Force { lateral: 0.1, normal: 0.2 });
//! ```

/// A lateral and a normal force on the probe, or what belongs to each: samples of them, their noise, their energy.
///
/// Lateral is along +x, normal is positive where it pushes the probe out of the gel. Where it holds numbers they are newtons.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Force<T> {
    /// Along +x.
    pub lateral: T,
    /// Out of the gel.
    pub normal: T,
}

impl<T> Force<T> {
    /// The lateral and the normal one.
    pub const fn new(lateral: T, normal: T) -> Force<T> {
        Force { lateral, normal }
    }

    /// The same function of either component.
    pub fn map<U>(self, mut function: impl FnMut(T) -> U) -> Force<U> {
        Force::new(function(self.lateral), function(self.normal))
    }

    /// Pairs the components of two forces.
    pub fn zip<U>(self, other: Force<U>) -> Force<(T, U)> {
        Force::new((self.lateral, other.lateral), (self.normal, other.normal))
    }

    /// The components by reference.
    pub const fn as_ref(&self) -> Force<&T> {
        Force::new(&self.lateral, &self.normal)
    }

    /// What each component points to, such as the samples of a vector.
    pub fn as_deref(&self) -> Force<&T::Target>
    where
        T: core::ops::Deref,
    {
        Force::new(&*self.lateral, &*self.normal)
    }

    /// Lateral first.
    pub fn into_array(self) -> [T; 2] {
        [self.lateral, self.normal]
    }
}

impl Force<f32> {
    /// No force.
    pub const ZERO: Force<f32> = Force::new(0.0, 0.0);
}
