//! Looks for words of Rust in Rust sources: by token, so that comments and strings say what they like.

use proc_macro2::{Delimiter, TokenStream, TokenTree};

/// One token of a flattened source.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Token {
    pub(crate) text: String,
    pub(crate) line: usize,
}

/// A forbidden word and where it stands.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Find {
    pub(crate) what: String,
    pub(crate) line: usize,
}

/// Whether items under `#[test]` and `#[cfg(test)]` count.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Tests {
    Counted,
    Ignored,
}

/// A list of forbidden sequences of tokens, and of forbidden modules of `std`.
pub(crate) struct Rule {
    pub(crate) sequences: &'static [&'static [&'static str]],
    pub(crate) std_modules: &'static [&'static str],
}

/// What only the kernel crate may say.
pub(crate) const FOREIGN_CODE: Rule = Rule { sequences: &[&["unsafe"], &["cxx"]], std_modules: &[] };

/// What a stage may not say: it takes a value and gives a value. The kernel's operations on files count, and so do
/// questions to the file system that name no module of `std` (methods of `Path`). Lists of names out of `openmesh` are
/// out altogether, because `read` could stand in any place of them.
pub(crate) const EFFECTS: Rule = Rule {
    sequences: &[
        &["print", "!"],
        &["println", "!"],
        &["eprint", "!"],
        &["eprintln", "!"],
        &["dbg", "!"],
        &["File", ":", ":"],
        &["OpenOptions"],
        &["stdin", "("],
        &["stdout", "("],
        &["stderr", "("],
        &["Instant"],
        &["SystemTime"],
        &["write_step"],
        &["read_step"],
        &["openmesh", ":", ":", "read"],
        &["openmesh", ":", ":", "{"],
        &["openmesh", ":", ":", "*"],
        &[".", "exists", "("],
        &[".", "try_exists", "("],
        &[".", "metadata", "("],
        &[".", "symlink_metadata", "("],
        &[".", "is_file", "("],
        &[".", "is_dir", "("],
        &[".", "is_symlink", "("],
        &[".", "read_dir", "("],
        &[".", "read_link", "("],
        &["canonicalize"],
    ],
    std_modules: &["fs", "env", "process", "net"],
};

/// Everything in `source` that `rule` forbids.
///
/// # Errors
/// The source is no Rust.
pub(crate) fn finds(source: &str, rule: &Rule, tests: Tests) -> Result<Vec<Find>, String> {
    let stream: TokenStream = source.parse().map_err(|error| format!("no Rust: {error}"))?;
    let mut tokens = Vec::new();
    flatten(stream, tests, &mut tokens);
    let at = |i: usize| {
        let rest = &tokens[i..];
        let sequences = rule.sequences.iter().filter(|s| begins_with(rest, s)).map(|s| s.concat());
        let modules = std_modules(rest).into_iter().filter(|m| rule.std_modules.contains(m));
        let line = tokens[i].line;
        sequences
            .chain(modules.map(|m| format!("std::{m}")))
            .map(move |what| Find { what, line })
            .collect::<Vec<_>>()
    };
    Ok((0..tokens.len()).flat_map(at).collect())
}

fn begins_with(tokens: &[Token], sequence: &[&str]) -> bool {
    tokens.len() >= sequence.len() && tokens.iter().zip(sequence).all(|(token, text)| token.text == *text)
}

/// The modules that `std::x` or `std::{x, y::z}` names at the start of `tokens`.
fn std_modules(tokens: &[Token]) -> Vec<&str> {
    if !begins_with(tokens, &["std", ":", ":"]) {
        return Vec::new();
    }
    if !begins_with(&tokens[3..], &["{"]) {
        return tokens.get(3).map(|token| token.text.as_str()).into_iter().collect();
    }
    let mut depth = 0;
    let mut modules = Vec::new();
    for pair in tokens[3..].windows(2) {
        match pair[0].text.as_str() {
            "{" => depth += 1,
            "}" => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            break;
        }
        if depth == 1 && ["{", ","].contains(&pair[0].text.as_str()) {
            modules.push(pair[1].text.as_str());
        }
    }
    modules
}

/// Groups become their delimiters and what is between them.
fn flatten(stream: TokenStream, tests: Tests, out: &mut Vec<Token>) {
    let trees: Vec<TokenTree> = stream.into_iter().collect();
    let mut i = 0;
    while i < trees.len() {
        if tests == Tests::Ignored && is_test_attribute(&trees[i..]) {
            i += item_length(&trees[i..]);
            continue;
        }
        push(&trees[i], tests, out);
        i += 1;
    }
}

fn push(tree: &TokenTree, tests: Tests, out: &mut Vec<Token>) {
    let line = tree.span().start().line;
    match tree {
        TokenTree::Group(group) => {
            let (open, close) = match group.delimiter() {
                Delimiter::Parenthesis => ("(", ")"),
                Delimiter::Brace => ("{", "}"),
                Delimiter::Bracket => ("[", "]"),
                Delimiter::None => ("", ""),
            };
            out.push(Token { text: open.to_owned(), line });
            flatten(group.stream(), tests, out);
            out.push(Token { text: close.to_owned(), line: group.span_close().start().line });
        }
        TokenTree::Literal(_) => out.push(Token { text: "literal".to_owned(), line }),
        other => out.push(Token { text: other.to_string(), line }),
    }
}

/// `#[test]`, `#[cfg(test)]`, `#[cfg(all(test, …))]`; never `#[cfg(not(test))]`.
fn is_test_attribute(trees: &[TokenTree]) -> bool {
    let [TokenTree::Punct(hash), TokenTree::Group(group), ..] = trees else { return false };
    let text: String = group.stream().to_string().split_whitespace().collect();
    hash.as_char() == '#' && (text == "test" || text == "cfg(test)" || text.starts_with("cfg(all(test,"))
}

/// How many trees the item has that begins with an attribute: up to its body or its semicolon.
fn item_length(trees: &[TokenTree]) -> usize {
    let ends = |tree: &TokenTree| match tree {
        TokenTree::Group(group) => group.delimiter() == Delimiter::Brace,
        TokenTree::Punct(punct) => punct.as_char() == ';',
        _ => false,
    };
    trees.iter().position(ends).map_or(trees.len(), |last| last + 1)
}
