"""Charts: shapes on a sheet, written as SVG and PNG."""
