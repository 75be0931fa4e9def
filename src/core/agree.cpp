#include "whirl/core/agree.hpp"

#include <algorithm>
#include <limits>
#include <new>
#include <string>
#include <vector>

#include "whirl/core/error.hpp"

namespace whirl::core {
namespace {

enum Kind : int { none = 0, domain, not_converged, input, error, bug };

Kind kind_of(const std::exception_ptr& e) {
  if (!e) return none;
  try {
    std::rethrow_exception(e);
  } catch (const DomainError&) {
    return domain;
  } catch (const NotConverged&) {
    return not_converged;
  } catch (const InputError&) {
    return input;
  } catch (const Bug&) {
    return bug;
  } catch (const Error&) {
    return error;
  } catch (const std::bad_alloc&) {
    return error;
  } catch (...) {
    return bug;
  }
}

std::string text_of(const std::exception_ptr& e) {
  try {
    std::rethrow_exception(e);
  } catch (const std::bad_alloc&) {
    return out_of_memory;
  } catch (const std::exception& x) {
    return x.what();
  } catch (...) {
    return "unknown exception";
  }
}

template <class E>
[[noreturn]] void throw_agreed(const std::string& text) {
  E e(text);
  e.mark_agreed();
  throw e;
}

}  // namespace

void agree(MPI_Comm comm, const std::function<void()>& local) {
  std::exception_ptr caught;
  try {
    local();
  } catch (...) {
    caught = std::current_exception();
  }
  int mine = kind_of(caught), worst = none;
  MPI_Allreduce(&mine, &worst, 1, MPI_INT, MPI_MAX, comm);
  if (worst == none) return;

  int rank = 0, size = 1;
  MPI_Comm_rank(comm, &rank);
  MPI_Comm_size(comm, &size);
  int candidate = mine == worst ? rank : size, source = size;
  MPI_Allreduce(&candidate, &source, 1, MPI_INT, MPI_MIN, comm);
  std::string text = rank == source ? text_of(caught) : std::string();
  int length = static_cast<int>(text.size());
  MPI_Bcast(&length, 1, MPI_INT, source, comm);
  text.resize(static_cast<std::size_t>(length));
  MPI_Bcast(text.data(), length, MPI_CHAR, source, comm);
  switch (worst) {
    case domain:
      throw_agreed<DomainError>(text);
    case not_converged:
      throw_agreed<NotConverged>(text);
    case input:
      throw_agreed<InputError>(text);
    case error:
      throw_agreed<Error>(text);
    default:
      throw_agreed<Bug>(text);
  }
}

void lead(MPI_Comm comm, int leader, const std::function<void(const std::function<void()>& together)>& work,
          const std::function<void()>& part) {
  int rank = 0;
  MPI_Comm_rank(comm, &rank);
  // Whether there is more to do: what the leader passes, whatever the others pass.
  const auto next = [&](int more) {
    MPI_Bcast(&more, 1, MPI_INT, leader, comm);
    return more != 0;
  };
  std::exception_ptr caught;
  if (rank == leader) {
    try {
      work([&] {
        next(1);
        part();
      });
    } catch (...) {
      caught = std::current_exception();
    }
    next(0);
  } else {
    while (next(0)) try {
        part();
      } catch (...) {
        // What the leader makes of it on its side ends the work.
        caught = std::current_exception();
      }
  }
  agree(comm, [&] {
    if (caught) std::rethrow_exception(caught);
  });
}

void share(MPI_Comm comm, double* values, std::size_t count) {
  // MPI counts in int.
  constexpr std::size_t most = std::numeric_limits<int>::max();
  for (std::size_t done = 0; done < count; done += most)
    MPI_Bcast(values + done, static_cast<int>(std::min(count - done, most)), MPI_DOUBLE, 0, comm);
}

bool is_agreed(const std::exception_ptr& e) {
  try {
    std::rethrow_exception(e);
  } catch (const Error& x) {
    return x.agreed();
  } catch (...) {
    return false;
  }
}

}  // namespace whirl::core
