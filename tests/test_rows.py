"""Rows that were written before an interruption are found again: the whole ones, all of them."""

import pytest

from validation.study.rows import append, whole_rows, write

COLUMNS = ("key", "message")
ROWS = [dict(zip(COLUMNS, row, strict=True)) for row in (("1", 'a comma, a "quote"'), ("2", "ü"), ("", ""))]


@pytest.fixture
def file(tmp_path):
    write(ROWS[:1], tmp_path / "rows.csv", COLUMNS)
    append(ROWS[1:], tmp_path / "rows.csv", COLUMNS)
    return tmp_path / "rows.csv"


def test_rows_are_read_as_they_were_written(file):
    assert whole_rows(file, COLUMNS) == ROWS
    assert whole_rows(file.with_name("none.csv"), COLUMNS) == []


def test_wherever_a_file_is_cut_the_whole_rows_before_are_found_and_others_come_after_them(file):
    data = file.read_bytes()
    for length in range(len(data)):
        file.write_bytes(data[:length])
        found = whole_rows(file, COLUMNS)
        assert found == ROWS[: max(data[:length].count(b"\n") - 1, 0)]
        write(found, file, COLUMNS)
        append(ROWS, file, COLUMNS)
        assert whole_rows(file, COLUMNS) == [*found, *ROWS]


@pytest.mark.parametrize("other", [b"key\n1\n", b"message,key\na,1\n", b"\xe4\n", b"\n", b""])
def test_rows_of_other_columns_are_none(file, other):
    file.write_bytes(other)
    assert whole_rows(file, COLUMNS) == []


def test_a_line_with_a_cell_too_many_or_too_few_is_no_row(file):
    """So are two that stand in one where a run went on after half a line."""
    file.write_bytes(file.read_bytes() + b"3\n4,a,b\n5,a\n")
    assert whole_rows(file, COLUMNS) == [*ROWS, {"key": "5", "message": "a"}]


def test_a_column_that_there_is_not_is_an_error(file):
    with pytest.raises(ValueError, match="other"):
        append([ROWS[0] | {"other": "1"}], file, COLUMNS)
    assert whole_rows(file, COLUMNS) == ROWS
