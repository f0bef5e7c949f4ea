"""What every study of many runs is made with: runs, statistics, tables, pages."""
