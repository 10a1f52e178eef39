"""Tables of users: CSV files and workbooks in one dialect, which `user_table` states."""
