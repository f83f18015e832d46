//! The image in use, checked and bound to the RAM it lies in.
//!
//! There is one image buffer. Its owner is either the configuration service, which may write to it, or the servo, in which
//! a [`Loaded`] image borrows it; the type leaves no third way, so the servo cycle never reads what somebody writes.
//! Reading and checking (tens of milliseconds) happen in the service; what changes hands in the servo cycle is a move of
//! a few hundred bytes.
//!
//! A rewriter borrows its image. Keeping both in one value that can be moved is what the `yoke` crate is for; there is
//! no unsafe code here.

use truepath_core::image::{Image, ImageError};
use truepath_core::rewrite::{Rewriter, Settings, SettingsError};
use yoke::{Yoke, Yokeable};

/// Why an image cannot be used.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LoadError {
    /// The bytes are no image.
    Image(ImageError),
    /// It does not go with the settings.
    Settings(SettingsError),
}

/// A rewriter that borrows its image from the buffer beside it.
#[derive(Yokeable)]
struct Held<'b>(Result<Rewriter<'b>, LoadError>);

/// An image in its buffer, with the rewriter made from it.
pub struct Loaded<'a>(Yoke<Held<'static>, &'a mut [u8]>);

impl<'a> Loaded<'a> {
    /// Checks the first `length` bytes of a buffer and makes a rewriter of them.
    ///
    /// # Errors
    /// The buffer back, and why.
    pub fn load(buffer: &'a mut [u8], length: usize, settings: &Settings) -> Result<Self, (&'a mut [u8], LoadError)> {
        let yoke: Yoke<Held<'static>, &'a mut [u8]> =
            Yoke::attach_to_cart(buffer, |bytes| Held(open(bytes.get(..length).unwrap_or(&[]), settings)));
        match yoke.get().0 {
            Ok(_) => Ok(Self(yoke)),
            Err(error) => Err((yoke.into_backing_cart(), error)),
        }
    }
    /// The rewriter. There always is one: [`Loaded::load`] keeps no failed one.
    pub fn rewriter(&self) -> Option<&Rewriter<'_>> {
        self.0.get().0.as_ref().ok()
    }
    /// Drops the rewriter and gives the buffer back; the image still lies in it.
    pub fn unload(self) -> &'a mut [u8] {
        self.0.into_backing_cart()
    }
}

fn open<'b>(bytes: &'b [u8], settings: &Settings) -> Result<Rewriter<'b>, LoadError> {
    let image = Image::new_checked(bytes).map_err(LoadError::Image)?;
    Rewriter::new(*settings, Some(image)).map_err(LoadError::Settings)
}
