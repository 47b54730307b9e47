/// Year, month and day of a number of days since 1970-01-01, by Howard Hinnant's algorithm `civil_from_days`
/// ("chrono-Compatible Low-Level Date Algorithms", 2013): years begin in March, so that a leap day is the last one of
/// its year.
///
/// ```
/// assert_eq!(saoms_api::host::calendar_date(0), (1970, 1, 1));
/// assert_eq!(saoms_api::host::calendar_date(19_782), (2024, 2, 29));
/// ```
pub const fn calendar_date(days: u64) -> (u64, u64, u64) {
    let day = days + 719_468;
    let (era, day_of_era) = (day / 146_097, day % 146_097);
    let year_of_era = (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let shifted_month = (5 * day_of_year + 2) / 153;
    let day_of_month = day_of_year - (153 * shifted_month + 2) / 5 + 1;
    let month = if shifted_month < 10 { shifted_month + 3 } else { shifted_month - 9 };
    let year = year_of_era + era * 400 + if month <= 2 { 1 } else { 0 };
    (year, month, day_of_month)
}
