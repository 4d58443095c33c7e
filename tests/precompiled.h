// The precompiled header of every test, like cmake/precompiled.h for the program.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "cmake/precompiled.h"
