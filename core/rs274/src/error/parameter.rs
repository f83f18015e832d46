//! Errors of parameters and of the memory for them.

use truepath_units::errors;

errors! {
    /// What is wrong with a parameter.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum ParameterError {
        /// More numbered parameters are set than the memory holds.
        TooMany {
            /// What it holds.
            limit: u16,
        } = "G080", "more than {limit} numbered parameters are set, which is all the memory; use fewer of them";
        /// More named parameters than the memory holds.
        TooManyNames {
            /// How many names it holds.
            limit: u16,
            /// How many bytes of names.
            bytes: u16,
        } = "G081",
            "more named parameters than the memory holds, {limit} names of {bytes} bytes together; use fewer or shorter names";
        /// A parameter number that does not exist.
        Number {
            /// The largest that does.
            largest: u16,
        } = "G082", "a parameter number lies between 1 and {largest}; correct the number";
        /// A parameter number with decimals.
        NotWhole = "G083", "a parameter number has no decimals; round it";
        /// A named parameter that was never set.
        NotDefined = "G084", "this parameter has no value yet; set it before it is used";
        /// A parameter that follows the machine is set.
        ReadOnly = "G085", "this parameter follows the machine and cannot be set; use another one";
    }
}
