#include "drivers/files/store/journal.hpp"
#include "drivers/iio/iio_session.hpp"
