//! Unpacking a file, told by its first bytes, whatever its name.

use flate2::bufread::MultiGzDecoder;
use std::io::{BufRead, BufReader, Cursor, Error, ErrorKind, Read, Result};

/// The first bytes of a file that is packed with gzip; no text begins so.
const GZIP: &[u8] = &[0x1f, 0x8b];
/// Some programs put it before the text.
const BYTE_ORDER_MARK: &[u8] = "\u{feff}".as_bytes();
/// Enough for each way to pack.
const MAX_START: u64 = 10;

/// Returns the text of a file: unpacked, without a byte order mark, and with a line end after each line. A packing that
/// is not unpacked is an error.
pub(super) fn text<'a>(source: impl Read + 'a) -> Result<impl Read + 'a> {
    let (start, whole) = peeked(source)?;
    let unpacked: Box<dyn Read + 'a> = if start.starts_with(GZIP) {
        Box::new(Unpacked(MultiGzDecoder::new(BufReader::new(whole))))
    } else {
        Box::new(whole)
    };
    let (start, mut text) = peeked(unpacked)?;
    if let Some(problem) = packing(&start) {
        return Err(Error::new(ErrorKind::InvalidData, problem));
    }
    if start.starts_with(BYTE_ORDER_MARK) {
        text.read_exact(&mut [0; BYTE_ORDER_MARK.len()])?;
    }
    Ok(text.chain(&b"\n"[..]))
}

/// Returns the complaint about what is packed, given its first bytes; none if it is not packed.
fn packing(start: &[u8]) -> Option<String> {
    let name = match start {
        [b'P', b'K', 3, 4, ..] => {
            let problem =
                "row 1: the file is packed (a zip, or a spreadsheet); save it as CSV in UTF-8";
            return Some(problem.to_owned());
        }
        [0x1f, 0x8b, ..] => "gzip more than once",
        [0xfd, b'7', b'z', b'X', b'Z', 0, ..] => "xz",
        // The level, then the beginning of a block, or the end of a file without one.
        [
            b'B',
            b'Z',
            b'h',
            b'1'..=b'9',
            b'1',
            b'A',
            b'Y',
            b'&',
            b'S',
            b'Y',
            ..,
        ]
        | [
            b'B',
            b'Z',
            b'h',
            b'1'..=b'9',
            0x17,
            b'r',
            b'E',
            b'8',
            b'P',
            0x90,
            ..,
        ] => "bzip2",
        [0x28, 0xb5, 0x2f, 0xfd, ..] => "zstd",
        [4, 0x22, 0x4d, 0x18, ..] => "lz4",
        [b'7', b'z', 0xbc, 0xaf, 0x27, 0x1c, ..] => "7z",
        _ => return None,
    };
    Some(format!(
        "row 1: the file is packed with {name}; unpack it, or pack it with gzip once"
    ))
}

/// Returns the first bytes of a source, and all of it.
fn peeked<'a>(mut source: impl Read + 'a) -> Result<(Vec<u8>, impl Read + 'a)> {
    let mut start = Vec::new();
    source.by_ref().take(MAX_START).read_to_end(&mut start)?;
    Ok((start.clone(), Cursor::new(start).chain(source)))
}

/// The output of a decoder; its errors say that it is one.
struct Unpacked<R>(MultiGzDecoder<R>);

impl<R: BufRead> Read for Unpacked<R> {
    fn read(&mut self, target: &mut [u8]) -> Result<usize> {
        self.0.read(target).map_err(|error| match error.kind() {
            ErrorKind::Interrupted => error,
            kind => {
                let problem =
                    format!("the gzip data are broken or cut off ({error}); pack the file again");
                Error::new(kind, problem)
            }
        })
    }
}
