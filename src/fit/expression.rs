//! Ties as users write them: `eta_r`, `2*a + b - 3`, `eta_g = eta_r`.

use thiserror::Error;

use super::assignment::Role;

/// Why an expression is none.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
pub enum ExpressionError {
    /// A name that no parameter has.
    #[error("the expression `{expression}` names `{name}`, which is no parameter.")]
    UnknownName {
        /// As written.
        expression: String,
        /// The name.
        name: String,
    },
    /// Something stands where something else should.
    #[error(
        "the expression `{expression}` has {found} at character {position} where {expected} should stand; write a sum such as `2*a + b - 3`."
    )]
    Unexpected {
        /// As written.
        expression: String,
        /// What stands there.
        found: String,
        /// Counted from 1.
        position: usize,
        /// What should.
        expected: &'static str,
    },
    /// Two parameters multiplied.
    #[error(
        "the expression `{expression}` multiplies or divides by parameter `{name}`; a tie is a sum of parameters times numbers."
    )]
    NotLinear {
        /// As written.
        expression: String,
        /// The second parameter.
        name: String,
    },
    /// A number beyond f64, or a division by zero.
    #[error("the expression `{expression}` has a number that is not finite.")]
    NotFinite {
        /// As written.
        expression: String,
    },
}

/// Reads a linear expression of parameters: terms joined by `+` and `-`, each a product of numbers and at most one name,
/// `a/2` for half of `a`. What stands before an `=`, if there is one, is not looked at. Names are letters, digits, `_`
/// and `.`, and begin with a letter or `_`.
///
/// # Errors
///
/// A sentence that names the expression, the place and what is wrong there.
pub fn parse_tie(expression: &str, index_of: impl Fn(&str) -> Option<usize>) -> Result<Role, ExpressionError> {
    let begin = expression.find('=').map_or(0, |place| place + 1);
    let mut reader = Reader { expression, tokens: tokens(expression, begin)?, next: 0 };
    let mut constant = 0.0;
    let mut terms: Vec<(usize, f64)> = Vec::new();
    let mut sign = reader.leading_sign();
    loop {
        let (factor, parameter) = reader.term(&index_of)?;
        match parameter {
            None => constant += sign * factor,
            Some(index) => match terms.iter_mut().find(|term| term.0 == index) {
                Some(term) => term.1 += sign * factor,
                None => terms.push((index, sign * factor)),
            },
        }
        sign = match reader.take() {
            None => break,
            Some((_, Token::Sign('+'))) => 1.0,
            Some((_, Token::Sign('-'))) => -1.0,
            Some((place, token)) => return Err(reader.unexpected(Some((place, &token)), "`+`, `-`, `*` or `/`")),
        };
    }
    if !constant.is_finite() || terms.iter().any(|term| !term.1.is_finite()) {
        return Err(ExpressionError::NotFinite { expression: expression.to_owned() });
    }
    Ok(Role::Tied { constant, terms })
}

#[derive(Debug, Clone, PartialEq)]
enum Token {
    Number(f64),
    Name(String),
    Sign(char),
}

struct Reader<'a> {
    expression: &'a str,
    /// Each with its place, counted from 1.
    tokens: Vec<(usize, Token)>,
    next: usize,
}

impl Reader<'_> {
    fn peek(&self) -> Option<&(usize, Token)> {
        self.tokens.get(self.next)
    }

    fn take(&mut self) -> Option<(usize, Token)> {
        let token = self.peek().cloned();
        self.next += 1;
        token
    }

    /// Takes the sign before a term, where there is one.
    fn leading_sign(&mut self) -> f64 {
        match self.peek() {
            Some((_, Token::Sign(sign @ ('+' | '-')))) => {
                let sign = if *sign == '-' { -1.0 } else { 1.0 };
                self.next += 1;
                sign
            }
            _ => 1.0,
        }
    }

    /// A product of numbers and at most one parameter.
    fn term(&mut self, index_of: &impl Fn(&str) -> Option<usize>) -> Result<(f64, Option<usize>), ExpressionError> {
        let (mut factor, mut parameter, mut divide) = (1.0, None, false);
        loop {
            let sign = self.leading_sign();
            match self.take() {
                Some((_, Token::Number(number))) if divide => factor /= sign * number,
                Some((_, Token::Number(number))) => factor *= sign * number,
                Some((_, Token::Name(name))) => {
                    let expression = || self.expression.to_owned();
                    let Some(index) = index_of(&name) else {
                        return Err(ExpressionError::UnknownName { expression: expression(), name });
                    };
                    if divide || parameter.is_some() {
                        return Err(ExpressionError::NotLinear { expression: expression(), name });
                    }
                    factor *= sign;
                    parameter = Some(index);
                }
                Some((place, token)) => return Err(self.unexpected(Some((place, &token)), "a name or a number")),
                None => return Err(self.unexpected(None, "a name or a number")),
            }
            match self.peek() {
                Some((_, Token::Sign(sign @ ('*' | '/')))) => {
                    divide = *sign == '/';
                    self.next += 1;
                }
                _ => return Ok((factor, parameter)),
            }
        }
    }

    fn unexpected(&self, found: Option<(usize, &Token)>, expected: &'static str) -> ExpressionError {
        let text = match found {
            None => "nothing".to_owned(),
            Some((_, Token::Number(number))) => format!("`{number}`"),
            Some((_, Token::Name(name))) => format!("`{name}`"),
            Some((_, Token::Sign(sign))) => format!("`{sign}`"),
        };
        let position = found.map_or_else(|| self.expression.chars().count() + 1, |(place, _)| place);
        ExpressionError::Unexpected { expression: self.expression.to_owned(), found: text, position, expected }
    }
}

/// Cuts an expression from byte `begin` on into tokens.
fn tokens(expression: &str, begin: usize) -> Result<Vec<(usize, Token)>, ExpressionError> {
    let mut tokens = Vec::new();
    let mut rest = &expression[begin..];
    while let Some(first) = rest.chars().next() {
        let place = expression[..expression.len() - rest.len()].chars().count() + 1;
        let length = if first.is_whitespace() {
            first.len_utf8()
        } else if "+-*/".contains(first) {
            tokens.push((place, Token::Sign(first)));
            1
        } else if first.is_ascii_digit() || first == '.' {
            let length = number_length(rest);
            let number = rest[..length].parse().map_err(|_| ExpressionError::Unexpected {
                expression: expression.to_owned(),
                found: format!("`{}`", &rest[..length]),
                position: place,
                expected: "a number",
            })?;
            tokens.push((place, Token::Number(number)));
            length
        } else if first.is_alphabetic() || first == '_' {
            let length = rest.find(|c: char| !(c.is_alphanumeric() || c == '_' || c == '.')).unwrap_or(rest.len());
            tokens.push((place, Token::Name(rest[..length].to_owned())));
            length
        } else {
            return Err(ExpressionError::Unexpected {
                expression: expression.to_owned(),
                found: format!("`{first}`"),
                position: place,
                expected: "a name, a number or a sign",
            });
        };
        rest = &rest[length..];
    }
    Ok(tokens)
}

/// Bytes of the number at the beginning: digits, a point, and an exponent with its sign.
fn number_length(text: &str) -> usize {
    let bytes = text.as_bytes();
    let mut length = bytes.iter().take_while(|byte| byte.is_ascii_digit() || **byte == b'.').count();
    if matches!(bytes.get(length), Some(b'e' | b'E')) {
        let signed = usize::from(matches!(bytes.get(length + 1), Some(b'+' | b'-')));
        let digits = bytes[length + 1 + signed..].iter().take_while(|byte| byte.is_ascii_digit()).count();
        if digits > 0 {
            length += 1 + signed + digits;
        }
    }
    length
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(expression: &str) -> Result<Role, ExpressionError> {
        parse_tie(expression, |name| ["a", "b", "film.d"].iter().position(|known| *known == name))
    }

    fn tied(constant: f64, terms: &[(usize, f64)]) -> Result<Role, ExpressionError> {
        Ok(Role::Tied { constant, terms: terms.to_vec() })
    }

    #[test]
    fn sums_of_parameters_times_numbers() {
        assert_eq!(parse("b"), tied(0.0, &[(1, 1.0)]));
        assert_eq!(parse("a = b"), tied(0.0, &[(1, 1.0)]));
        assert_eq!(parse("2*a + b - 3"), tied(-3.0, &[(0, 2.0), (1, 1.0)]));
        assert_eq!(parse("-film.d/4*2 + 1e-3"), tied(1e-3, &[(2, -0.5)]));
        assert_eq!(parse("a - a*3"), tied(0.0, &[(0, -2.0)]));
        assert_eq!(parse("-2*-a"), tied(0.0, &[(0, 2.0)]));
    }

    #[test]
    fn mistakes_are_named() {
        let text = |expression: &str| parse(expression).unwrap_err().to_string();
        assert!(text("a + c").contains("names `c`, which is no parameter"), "{}", text("a + c"));
        assert!(text("a * b").contains("multiplies or divides by parameter `b`"), "{}", text("a * b"));
        assert!(text("1 / a").contains("divides by parameter `a`"), "{}", text("1 / a"));
        assert!(text("a b").contains("has `b` at character 3"), "{}", text("a b"));
        assert!(text("a +").contains("has nothing at character 4"), "{}", text("a +"));
        assert!(text("").contains("has nothing at character 1"), "{}", text(""));
        assert!(text("2^a").contains("has `^` at character 2"), "{}", text("2^a"));
        assert!(text("1.2.3*a").contains("`1.2.3`"), "{}", text("1.2.3*a"));
        assert!(text("a/0").contains("not finite"), "{}", text("a/0"));
    }
}
