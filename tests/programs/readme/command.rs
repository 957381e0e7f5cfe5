//! The lines of a page's `sh` blocks, and what each asks for.

/// Lines that begin with one of these words are for the reader's own machine: they fetch, build or test the
/// project, which is what is under way here already.
const LEFT_ALONE: [&[&str]; 9] = [
    &["git", "clone"],
    &["cd"],
    &["cargo", "build"],
    &["cargo", "install"],
    &["cargo", "test"],
    &["cargo", "bench"],
    &["cargo", "doc"],
    &["pip", "install"],
    &["SANDTABLE_BLESS=1", "cargo", "test"],
];

/// What runs this program; the rest of the line is its arguments.
const PROGRAMS: [&[&str]; 4] = [
    &["cargo", "run", "--release", "--"],
    &["cargo", "run", "--"],
    &["sandtable"],
    &["target/release/sandtable"],
];

/// A command on one line of a page.
#[derive(Debug, PartialEq, Eq)]
pub struct Line {
    /// Its number in the page, from 1.
    pub number: usize,
    /// The command, lines ending in a backslash joined.
    pub text: String,
}

/// What a line asks for.
#[derive(Debug, PartialEq, Eq)]
pub enum Command {
    /// Something this test leaves alone.
    LeftAlone,
    /// A run of the program.
    Sandtable {
        /// Its arguments.
        arguments: Vec<String>,
        /// What `echo` or `printf` pipes into it.
        input: Option<String>,
    },
    /// The program as a service, which the questions after it are put to.
    Serve {
        /// Its arguments after `serve`, without the address.
        arguments: Vec<String>,
    },
    /// A question to the service: what follows its address.
    Ask {
        /// Path and query.
        path: String,
    },
}

/// Where the service listens unless told otherwise.
const SERVICE: &str = "http://127.0.0.1:8080";

impl Command {
    /// What `text` asks for; `None` where it is nothing known.
    pub fn parse(text: &str) -> Option<Self> {
        let mut words = words(text)?;
        if LEFT_ALONE.iter().any(|start| begins(&words, start)) {
            return Some(Self::LeftAlone);
        }
        let mut input = None;
        if let Some(pipe) = words.iter().position(|word| *word == Word::Operator('|')) {
            input = Some(piped(&words[..pipe])?);
            words.drain(..=pipe);
        }
        if let [Word::Plain(program), Word::Plain(url)] = &words[..]
            && program == "curl"
        {
            return Some(Self::Ask { path: url.strip_prefix(SERVICE)?.to_owned() });
        }
        let start = PROGRAMS.iter().find(|start| begins(&words, start))?;
        let mut arguments: Vec<String> =
            words.into_iter().skip(start.len()).map(Word::plain).collect::<Option<_>>()?;
        if arguments.first().is_some_and(|first| first == "serve") {
            return Some(Self::Serve { arguments: arguments.split_off(1) });
        }
        Some(Self::Sandtable { arguments, input })
    }
}

/// What an `echo` or a `printf` without placeholders writes.
fn piped(words: &[Word]) -> Option<String> {
    match words {
        [Word::Plain(program), Word::Plain(text)] if program == "echo" => Some(format!("{text}\n")),
        [Word::Plain(program), Word::Plain(text)] if program == "printf" && !text.contains('%') => {
            Some(text.replace("\\n", "\n"))
        }
        _ => None,
    }
}

/// The commands in blocks marked `sh`, without comments, empty lines and prompts.
pub fn lines_of(page: &str) -> Vec<Line> {
    let mut found: Vec<Line> = Vec::new();
    let (mut in_block, mut joins) = (false, false);
    for (index, line) in page.lines().enumerate() {
        let line = line.trim();
        if line.starts_with("```") {
            in_block = !in_block && line == "```sh";
            continue;
        }
        let text = line.strip_prefix("$ ").unwrap_or(line);
        if !in_block || text.is_empty() || text.starts_with('#') {
            continue;
        }
        let (text, continues) = text.strip_suffix('\\').map_or((text, false), |text| (text.trim_end(), true));
        match found.last_mut().filter(|_| joins) {
            Some(last) => last.text = format!("{} {text}", last.text),
            None => found.push(Line { number: index + 1, text: text.into() }),
        }
        joins = continues;
    }
    found
}

/// A word of a command line.
#[derive(Debug, PartialEq, Eq)]
enum Word {
    Plain(String),
    Operator(char),
}

impl Word {
    fn plain(self) -> Option<String> {
        match self {
            Self::Plain(text) => Some(text),
            Self::Operator(_) => None,
        }
    }
}

fn begins(words: &[Word], start: &[&str]) -> bool {
    let same = |(word, start): (&Word, &&str)| matches!(word, Word::Plain(text) if text == start);
    words.len() >= start.len() && words.iter().zip(start).all(same)
}

/// The words of `text` as a shell would split them, as far as quotes and comments go; `None` for an open quote.
fn words(text: &str) -> Option<Vec<Word>> {
    let (mut words, mut word, mut quote) = (Vec::new(), None::<String>, None::<char>);
    for letter in text.chars() {
        match (quote, letter) {
            (Some(open), _) if letter == open => quote = None,
            (Some(_), _) => word.get_or_insert_default().push(letter),
            (None, '\'' | '"') => {
                quote = Some(letter);
                word.get_or_insert_default();
            }
            (None, '#') if word.is_none() => break,
            (None, '|' | '>' | '<' | ';' | '&' | '$' | '`' | '*') => {
                words.extend(word.take().map(Word::Plain));
                words.push(Word::Operator(letter));
            }
            (None, _) if letter.is_whitespace() => words.extend(word.take().map(Word::Plain)),
            (None, _) => word.get_or_insert_default().push(letter),
        }
    }
    words.extend(word.map(Word::Plain));
    quote.is_none().then_some(words)
}

#[test]
fn commands_are_told_from_lines_to_leave_alone_and_from_the_unknown() {
    let run = |arguments: &[&str], input: Option<&str>| {
        let arguments = arguments.iter().map(|&argument| argument.to_owned()).collect();
        Some(Command::Sandtable { arguments, input: input.map(str::to_owned) })
    };
    let given = "cargo run --release -- render 'a b.toml' -o \"c d.png\"  # a comment";
    assert_eq!(Command::parse(given), run(&["render", "a b.toml", "-o", "c d.png"], None));
    let given = "printf '1,2\\n' | sandtable height dem.tif --points -";
    assert_eq!(Command::parse(given), run(&["height", "dem.tif", "--points", "-"], Some("1,2\n")));
    assert_eq!(Command::parse("cargo test --release"), Some(Command::LeftAlone));
    for unknown in
        ["rm -r /", "sandtable check a.toml && rm b", "sandtable check 'a.toml", "cat a | sandtable", "ls"]
    {
        assert_eq!(Command::parse(unknown), None, "{unknown}");
    }
}

#[test]
fn only_sh_blocks_have_commands_and_a_backslash_joins_lines() {
    let page = "```toml\na = 1\n```\ntext\n```sh\n# why\n$ sandtable check \\\n    a.toml\n\ncd b\n```\n```\nc\n```\n";
    let line = |number, text: &str| Line { number, text: text.into() };
    assert_eq!(lines_of(page), [line(7, "sandtable check a.toml"), line(10, "cd b")]);
}
