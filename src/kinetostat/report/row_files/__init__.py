"""Rows to files, as many as there are: CSV, NPZ and Parquet, written as they come, whole or not at all.

A writer takes rows in blocks and keeps none of them, so a file may be larger than memory. What it needs beside the
file, it takes from the same disk.
"""

from kinetostat.report.row_files.csv import CsvRows
from kinetostat.report.row_files.fields import Numbers, RowField, RowWriter
from kinetostat.report.row_files.opening import ENDINGS, check_row_file, open_rows

__all__ = ["ENDINGS", "CsvRows", "Numbers", "RowField", "RowWriter", "check_row_file", "open_rows"]
