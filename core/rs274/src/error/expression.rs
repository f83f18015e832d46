//! Errors of expressions.

use truepath_units::errors;

errors! {
    /// What is wrong with an expression.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum ExpressionError {
        /// No number, parameter, function or bracket where one must stand.
        ValueMissing = "G160", "a number, a parameter, a function or `[` must stand here; write one";
        /// A name that is no function.
        Function = "G161",
            "this is no function; ABS ACOS ASIN ATAN COS EXISTS EXP FIX FUP LN ROUND SIN SQRT TAN are, with their argument in [ ]";
        /// Something else than an operator or `]` behind a value.
        Operator(byte: u8) = "G162",
            "an operator or `]` must stand here, not `{byte}`; correct the expression", byte = byte.escape_ascii();
        /// `[` without `]`.
        BracketNotClosed = "G163", "the bracket opened by `[` is not closed in this line; add `]`";
        /// `<` without `>`.
        NameNotClosed = "G164", "the name opened by `<` is not closed in this line; add `>`";
        /// `#<>`.
        NameEmpty = "G165", "a parameter without a name; write one between `<` and `>`";
        /// A name longer than is kept.
        NameTooLong {
            /// Bytes kept.
            limit: u8,
        } = "G166", "a name has more than {limit} letters; use a shorter one";
        /// A number with more than 18 digits before its point.
        NumberTooLarge = "G167", "this number has more than 18 digits before its point; is a point missing?";
        /// More brackets and operators wait than there is room for.
        TooDeep {
            /// How many may wait.
            limit: u8,
        } = "G168",
            "more than {limit} brackets and operators wait for each other; split the expression into several parameters";
        /// `ATAN[y]` without `/[x]`.
        AtanNeedsTwo = "G169", "ATAN takes two numbers; write ATAN[y]/[x]";
        /// `EXISTS` of something else than a parameter.
        ExistsWithoutParameter = "G170", "EXISTS takes one parameter; write EXISTS[#<name>]";
        /// Division by zero, or `MOD` of zero.
        DivisionByZero = "G171", "this divides by zero; correct the divisor";
        /// A negative number to a power that is not whole.
        NegativePower = "G172", "a negative number has no power that is not whole; correct base or exponent";
        /// `ASIN` or `ACOS` beyond ±1.
        ArcOutOfRange = "G173", "ASIN and ACOS take numbers from -1 to 1; correct the argument";
        /// `LN` of zero or less.
        LogarithmOfNothing = "G174", "LN takes numbers above 0; correct the argument";
        /// `SQRT` of less than zero.
        RootOfNegative = "G175", "SQRT takes no negative numbers; correct the argument";
        /// The result is no finite number.
        NotFinite = "G176", "the result is too large to be a number; correct the expression";
    }
}
